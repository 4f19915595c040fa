import { ACCURACY_PRESETS, type AccuracyPreset } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { formatCount, formatMs } from '@websplatter/kit/format';
import { useEffect } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import type { JudgedPictures } from '../state/measured.ts';
import { nearestPreset, PRESET_NAMES } from '../state/nearest-preset.ts';
import { Pixels } from './compared-pictures.tsx';

/** Frame times of displays at 120 and 60 frames a second, ms. */
const DISPLAY_MS = [1000 / 120, 1000 / 60];
/** Longest bar, as a multiple of the bar of `reference`. */
const MOST_OF_REFERENCE = 3;
const STAGES = ['preprocess', 'sort', 'rasterize'] as const;

/**
 * The presets, with measured time and error if available. Hovering shows a preset's picture; a
 * click selects it.
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
  // A target chooses settings, not presets, even if they equal a preset.
  const chosen = target === null && changed.length === 0 ? preset : null;
  // The bars' scale is limited, so that a very slow preset leaves the others visible.
  const referenceMs =
    costs.find(({ name }) => name === 'reference')?.totalMs.median ?? Number.POSITIVE_INFINITY;
  const longestMs = Math.min(
    MOST_OF_REFERENCE * referenceMs,
    Math.max(0, ...costs.map(({ totalMs }) => totalMs.median)),
  );
  const look = (looked: AccuracyPreset | null) => store.setState({ looked });
  // Unmounting sends no pointerleave event.
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

/** The median and the confidence interval of a time, ms. */
interface Spread {
  readonly median: number;
  readonly low: number;
  readonly high: number;
}

/** Time and error of one preset. */
export interface PresetCost {
  readonly name: string;
  readonly totalMs: Spread;
  /** Medians of pre-process, sort and rasterize, ms; null if only the total is known. */
  readonly stagesMs: readonly number[] | null;
  /** Largest channel error against `reference`, in steps of an 8-bit channel. */
  readonly maxSteps: number;
}

/** Times that differ by less than this fraction count as equal. */
const ALIKE_PART = 0.1;

export function costOf({ name, timeMs, error }: AccuracyPoint): PresetCost {
  const stages = [timeMs.preprocess, timeMs.sort, timeMs.rasterize].flatMap((each) => each?.median ?? []);
  return {
    name,
    totalMs: timeMs.total,
    stagesMs: stages.length === 3 ? stages : null,
    maxSteps: 255 * error.maxError,
  };
}

/**
 * Summarizes the presets' costs: the fastest preset without visible errors, and the fastest of all.
 * Null if `reference` was not measured.
 */
export function verdictOf(costs: readonly PresetCost[]): string | null {
  const reference = costs.find(({ name }) => name === 'reference');
  if (!reference || costs.length === 1) return null;
  const quicker = costs
    .filter(({ totalMs }) => totalMs.high < reference.totalMs.low)
    .sort((a, b) => a.totalMs.median - b.totalMs.median);
  if (quicker.length === 0) {
    const ratios = costs.map(({ totalMs }) => totalMs.median / reference.totalMs.median);
    if (Math.min(...ratios) < 1 - ALIKE_PART)
      return 'Times vary too much here to tell whether any preset is quicker than reference.';
    const isAlike = Math.max(...ratios) <= 1 + ALIKE_PART;
    const finding = isAlike ? 'All presets take about the same here' : 'No preset is quicker here';
    return `${finding}: the exact picture of reference costs nothing more.`;
  }
  const invisible = quicker.find(({ maxSteps }) => Math.round(maxSteps) <= 1);
  const told = invisible && invisible !== quicker[0] ? [invisible, quicker[0]] : [quicker[0]];
  return told
    .map((cost, i) => {
      const part = 1 - cost.totalMs.median / reference.totalMs.median;
      const than = i === 0 ? ' than reference' : '';
      return `${cost.name} is ${Math.round(100 * part)} % quicker${than}: ${errorWords(cost.maxSteps)}.`;
    })
    .join(' ');
}

/** `no pixel is off by more than 1 of 255`. */
function errorWords(maxSteps: number): string {
  const steps = Math.round(maxSteps);
  if (steps === 0) return 'every pixel is the same';
  return steps === 1
    ? 'no pixel is off by more than 1 of 255'
    : `a pixel is off by up to ${formatCount(steps)} of 255`;
}

/** The error as a table cell: `identical`, `largest error 12 of 255`. */
export function errorLabel(maxSteps: number): string {
  const steps = Math.round(maxSteps);
  return steps === 0 ? 'identical' : `largest error ${formatCount(steps)} of 255`;
}
