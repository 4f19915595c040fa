import { ACCURACY_PRESETS, type AccuracyPreset } from '@websplatter/core';
import { useEffect } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import type { JudgedPictures } from '../state/measured.ts';
import { nearestPreset, PRESET_NAMES } from '../state/nearest-preset.ts';
import { formatMs } from '../ui/format.ts';
import { Pixels } from './looked-picture.tsx';
import { errorLabel, type PresetCost } from './verdict.ts';

/** Times of a frame that displays allow at 120 and at 60 frames a second, ms. */
const DISPLAY_MS = [1000 / 120, 1000 / 60];
/** Bars end at so many times that of `reference`. */
const MOST_OF_REFERENCE = 3;
const STAGES = ['preprocess', 'sort', 'rasterize'] as const;

/**
 * The presets with their time and error, if there are any: one under the pointer shows its picture,
 * a click keeps it.
 */
export function PresetRows({
  store,
  viewer,
  costs = [],
  pictures = null,
}: PanelProps & { readonly costs?: readonly PresetCost[]; readonly pictures?: JudgedPictures | null }) {
  const hasCosts = costs.length > 0;
  const accuracy = useStore(store, (state) => state.accuracy);
  const target = useStore(store, (state) => state.target);
  const { preset, changed } = nearestPreset(accuracy);
  // Under a target no preset was chosen, even if the chosen settings equal one.
  const chosen = target === null && changed.length === 0 ? preset : null;
  // One that takes far longer leaves the others their bars.
  const referenceMs =
    costs.find(({ name }) => name === 'reference')?.totalMs.median ?? Number.POSITIVE_INFINITY;
  const longestMs = Math.min(
    MOST_OF_REFERENCE * referenceMs,
    Math.max(0, ...costs.map(({ totalMs }) => totalMs.median)),
  );
  const look = (looked: AccuracyPreset | null) => store.setState({ looked });
  // A row that goes with its panel is not left.
  useEffect(() => () => store.setState({ looked: null }), [store]);
  return (
    <fieldset className={hasCosts ? 'preset-rows' : 'chips'} aria-label="Presets">
      {PRESET_NAMES.map((name) => {
        const cost = costs.find((each) => each.name === name);
        const picture = pictures?.[name];
        return (
          <button
            key={name}
            type="button"
            className={hasCosts ? 'preset-row' : 'chip'}
            aria-pressed={name === chosen}
            data-testid={`preset-${name}`}
            onClick={() => viewer.setAccuracy(ACCURACY_PRESETS[name])}
            onPointerEnter={() => look(name)}
            onPointerLeave={() => look(null)}
            onFocus={() => look(name)}
            onBlur={() => look(null)}
          >
            <b>{name}</b>
            {cost && <Cost cost={cost} longestMs={longestMs} />}
            {picture && <Pixels image={picture.error} />}
          </button>
        );
      })}
    </fieldset>
  );
}

function Cost({ cost, longestMs }: { readonly cost: PresetCost; readonly longestMs: number }) {
  const { totalMs, stagesMs, maxSteps } = cost;
  const width = (ms: number) => `${(100 * ms) / longestMs}%`;
  return (
    <span className="preset-cost">
      <span className="preset-bar" data-cut={totalMs.median > longestMs || undefined} aria-hidden="true">
        {stagesMs
          ? STAGES.map((stage, i) => (
              <i key={stage} className={`stage-${stage}`} style={{ width: width(stagesMs[i]) }} />
            ))
          : longestMs > 0 && <i style={{ width: width(totalMs.median) }} />}
        {DISPLAY_MS.filter((ms) => ms < longestMs && ms > longestMs / 50).map((ms) => (
          <em key={ms} style={{ left: width(ms) }} />
        ))}
      </span>
      <small>
        {formatMs(totalMs.median)} ms · {errorLabel(maxSteps)}
      </small>
    </span>
  );
}
