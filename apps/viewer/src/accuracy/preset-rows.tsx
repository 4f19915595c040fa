import { ACCURACY_PRESETS, type AccuracyPreset } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { formatCount, formatMs } from '@websplatter/kit/format';
import { useEffect } from 'react';
import { useStore } from 'zustand';
import { setAccuracy } from '../engine/edit-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { nearestPreset, PRESET_NAMES } from '../state/accuracy.ts';
import type { JudgedPicture, JudgedPictures } from '../state/measured.ts';
import { PRESET_WORDS } from '../ui/accuracy-words.ts';
import { formatPart, Pixels } from './compared-pictures.tsx';

/** Refresh rates of displays, per second: bars have a tick where a frame takes as long. */
const DISPLAY_HZ = [120, 60];
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
  isExample = false,
  isDescribed = false,
}: PanelProps & {
  readonly costs?: readonly PresetCost[];
  readonly pictures?: JudgedPictures | null;
  /** Whether another device's costs are shown, which recommend nothing here. */
  readonly isExample?: boolean;
  /** Whether presets whose cost is unknown are rows with a description, rather than chips. */
  readonly isDescribed?: boolean;
}) {
  const hasCosts = costs.length > 0;
  const hasRows = hasCosts || isDescribed;
  const accuracy = useStore(store, (state) => state.accuracy);
  const target = useStore(store, (state) => state.target);
  const { preset, changed } = nearestPreset(accuracy);
  // A target chooses settings, not presets, even if they equal a preset.
  const chosen = target === null && changed.length === 0 ? preset : null;
  // The bars' scale is limited, so that a very slow preset leaves the others visible.
  const referenceMs = referenceOf(costs)?.totalMs.median ?? Number.POSITIVE_INFINITY;
  const longestMs = Math.min(
    MOST_OF_REFERENCE * referenceMs,
    Math.max(0, ...costs.map(({ totalMs }) => totalMs.high)),
  );
  const recommended = isExample ? null : recommendedOf(costs);
  const look = (looked: AccuracyPreset | null) => store.setState({ looked });
  // Unmounting sends no pointerleave event.
  useEffect(() => () => store.setState({ looked: null }), [store]);
  return (
    <fieldset
      className={hasRows ? 'preset-rows' : 'chips'}
      aria-label="Presets"
      data-pictures={(hasCosts && !isExample) || undefined}
    >
      {PRESET_NAMES.map((name) => {
        const cost = costs.find((each) => each.name === name);
        const picture = pictures?.[name];
        return (
          <button
            key={name}
            type="button"
            className={hasRows ? 'preset-row' : 'chip'}
            title={PRESET_WORDS[name]}
            aria-pressed={name === chosen}
            data-testid={`preset-${name}`}
            onClick={() => setAccuracy({ store, viewer }, ACCURACY_PRESETS[name])}
            onPointerEnter={() => look(name)}
            onPointerLeave={() => look(null)}
            onFocus={() => look(name)}
            onBlur={() => look(null)}
          >
            <b>{name}</b>
            {!hasCosts && isDescribed && <small className="preset-cost">{PRESET_WORDS[name]}</small>}
            {cost && (
              <Cost
                cost={cost}
                longestMs={longestMs}
                picture={picture}
                isRecommended={name === recommended}
              />
            )}
            {picture && <Pixels image={picture.error} />}
          </button>
        );
      })}
      <Ticks longestMs={longestMs} />
    </fieldset>
  );
}

function Cost({
  cost,
  longestMs,
  picture,
  isRecommended,
}: {
  readonly cost: PresetCost;
  readonly longestMs: number;
  readonly picture: JudgedPicture | undefined;
  readonly isRecommended: boolean;
}) {
  const { totalMs, maxSteps } = cost;
  const lowMs = Math.min(totalMs.low, longestMs);
  const highMs = Math.min(totalMs.high, longestMs);
  return (
    <span className="preset-cost">
      <span className="preset-bar" data-cut={totalMs.median > longestMs || undefined} aria-hidden="true">
        {barParts(cost).map(({ stage, ms }) => (
          <i key={stage} className={`stage-${stage}`} style={{ width: share(ms, longestMs) }} />
        ))}
        {highMs > lowMs && (
          <span
            className="preset-whisker"
            style={{ left: share(lowMs, longestMs), width: share(highMs - lowMs, longestMs) }}
          />
        )}
        {ticksWithin(longestMs).map((hz) => (
          <em key={hz} style={{ left: share(1000 / hz, longestMs) }} />
        ))}
      </span>
      <small>
        {formatMs(totalMs.median)} ms · {errorLabel(maxSteps)}
        {picture && picture.beyond1 > 0 && `, ${beyondLabel(picture)}`}{' '}
        {isHardlyVisible(cost) && Math.round(maxSteps) > 0 && (
          <mark>{isInvisible(cost) ? 'error not visible' : 'error hardly visible'}</mark>
        )}
        {isRecommended && <mark data-testid="recommended">recommended</mark>}
      </small>
    </span>
  );
}

/** Names the ticks of all rows. */
function Ticks({ longestMs }: { readonly longestMs: number }) {
  const ticks = ticksWithin(longestMs);
  if (ticks.length === 0) return null;
  return (
    <div className="preset-ticks" aria-hidden="true">
      {ticks.map((hz) => (
        <small key={hz} style={{ left: share(1000 / hz, longestMs) }}>
          {hz} fps
        </small>
      ))}
    </div>
  );
}

const share = (ms: number, longestMs: number) => `${(100 * ms) / longestMs}%`;

/** Refresh rates whose ticks can be told from the ends of the bars. */
function ticksWithin(longestMs: number): number[] {
  return DISPLAY_HZ.filter((hz) => 1000 / hz < longestMs && 1000 / hz > longestMs / 50);
}

/**
 * Parts of a preset's bar. Together they are as long as its total: medians of stages do not add up
 * to the median of their sum, and of two presets the one with the greater number would have the
 * shorter bar.
 */
export function barParts({ totalMs, stagesMs }: Pick<PresetCost, 'totalMs' | 'stagesMs'>): readonly {
  readonly stage: string;
  readonly ms: number;
}[] {
  const sumMs = stagesMs?.reduce((sum, ms) => sum + ms, 0) ?? 0;
  if (!stagesMs || !(sumMs > 0)) return totalMs.median > 0 ? [{ stage: 'unknown', ms: totalMs.median }] : [];
  return STAGES.map((stage, i) => ({ stage, ms: (stagesMs[i] * totalMs.median) / sumMs }));
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
  /** Error that 99.9 % of the channels do not exceed, in the same steps. */
  readonly p999Steps: number;
}

/** Times that differ by less than this fraction count as equal. */
const ALIKE_PART = 0.1;
/** Errors up to this, in steps of an 8-bit channel, are faint where they are rare. */
const FAINT_STEPS = 8;
/** Intervals wider than this fraction of their median say little. */
const UNSURE_PART = 0.3;

export function costOf({ name, timeMs, error }: AccuracyPoint): PresetCost {
  const stages = [timeMs.preprocess, timeMs.sort, timeMs.rasterize].flatMap((each) => each?.median ?? []);
  return {
    name,
    totalMs: timeMs.total,
    stagesMs: stages.length === 3 ? stages : null,
    maxSteps: 255 * error.maxError,
    p999Steps: 255 * error.p999Error,
  };
}

const referenceOf = (costs: readonly PresetCost[]) => costs.find(({ name }) => name === 'reference');

/** Presets that are certainly quicker than `reference`, the quickest first. */
function quickerThan(reference: PresetCost, costs: readonly PresetCost[]): PresetCost[] {
  return costs
    .filter(({ totalMs }) => totalMs.high < reference.totalMs.low)
    .sort((a, b) => a.totalMs.median - b.totalMs.median);
}

const isInvisible = ({ name, maxSteps }: PresetCost) => name !== 'reference' && Math.round(maxSteps) <= 1;

/** Whether all but one in a thousand errors are invisible, and the others are faint. */
const isHardlyVisible = ({ name, maxSteps, p999Steps }: PresetCost) =>
  name !== 'reference' && Math.round(p999Steps) <= 1 && Math.round(maxSteps) <= FAINT_STEPS;

const areAllMeasured = (costs: readonly PresetCost[]) =>
  PRESET_NAMES.every((name) => costs.some((cost) => cost.name === name));

/**
 * The quickest preset whose errors hardly anybody sees, `reference` if none is quicker; null until all presets
 * are measured, and where their times cannot tell.
 */
export function recommendedOf(costs: readonly PresetCost[]): string | null {
  const reference = referenceOf(costs);
  if (!reference || !areAllMeasured(costs) || areUnsure(costs)) return null;
  return (quickerThan(reference, costs).find(isHardlyVisible) ?? reference).name;
}

/** Whether times vary so much that a preset may be quicker than `reference` by more than their medians say. */
function areUnsure(costs: readonly PresetCost[]): boolean {
  const reference = referenceOf(costs);
  if (!reference || quickerThan(reference, costs).length > 0) return false;
  const { median, high } = reference.totalMs;
  return costs.some(
    ({ totalMs }) =>
      totalMs.median < (1 - ALIKE_PART) * median ||
      (totalMs.low < high && totalMs.high - totalMs.low > UNSURE_PART * totalMs.median),
  );
}

/**
 * Compares the time of the exact picture with that of the fastest preset whose errors hardly anybody sees. If
 * another preset is faster still, a second sentence tells its time and error. Null until all presets are
 * measured, because each may change the answer.
 */
export function verdictOf(costs: readonly PresetCost[]): string | null {
  const reference = referenceOf(costs);
  if (!reference || !areAllMeasured(costs)) return null;
  const quicker = quickerThan(reference, costs);
  if (quicker.length === 0) {
    if (areUnsure(costs))
      return 'Times vary too much here to tell what the exact picture costs. Measure again when the device is idle.';
    const ratios = costs.map(({ totalMs }) => totalMs.median / reference.totalMs.median);
    const isAlike = Math.max(...ratios) <= 1 + ALIKE_PART;
    const finding = isAlike ? 'all presets take about the same' : 'no preset is quicker than reference';
    return `The exact picture costs nothing more here: ${finding}.`;
  }
  const first = quicker.find(isHardlyVisible) ?? quicker[0];
  const [exactMs, firstMs] = [reference, first].map(({ totalMs }) => formatMs(totalMs.median));
  const verdict = `The exact picture costs ${exactMs} ms per frame instead of ${firstMs} with ${first.name}, where ${errorWords(first)}.`;
  if (first === quicker[0]) return verdict;
  const [quickest] = quicker;
  return `${verdict} ${quickest.name} takes ${formatMs(quickest.totalMs.median)} ms, but there ${errorWords(quickest)}.`;
}

/** `no pixel is off by more than 1 of 255`. */
function errorWords(cost: PresetCost): string {
  const steps = Math.round(cost.maxSteps);
  if (steps === 0) return 'every pixel is the same';
  if (steps === 1) return 'no pixel is off by more than 1 of 255';
  return isHardlyVisible(cost)
    ? `99.9 % of the colours are within 1 of 255, and the worst is off by ${formatCount(steps)}`
    : `a pixel is off by up to ${formatCount(steps)} of 255`;
}

/** The error as a table cell: `identical`, `largest error 12 of 255`. */
export function errorLabel(maxSteps: number): string {
  const steps = Math.round(maxSteps);
  return steps === 0 ? 'identical' : `largest error ${formatCount(steps)} of 255`;
}

/** `0.3 % of pixels above 1`, and above 8 if any are. */
export function beyondLabel({ beyond1, beyond8 }: Pick<JudgedPicture, 'beyond1' | 'beyond8'>): string {
  const percent = (part: number) => formatPart(part).replaceAll(' ', '\u00a0');
  const above8 = beyond8 > 0 ? `, ${percent(beyond8)} above 8` : '';
  return `${percent(beyond1)} of pixels above 1${above8}`;
}
