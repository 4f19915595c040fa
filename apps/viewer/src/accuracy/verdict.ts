import type { AccuracyPoint } from '@websplatter/core/measure';
import { formatCount } from '../ui/format.ts';

/** The median and the bounds of a time, ms. */
interface Spread {
  readonly median: number;
  readonly low: number;
  readonly high: number;
}

/** Time and error of one preset. */
export interface PresetCost {
  readonly name: string;
  readonly totalMs: Spread;
  /** Medians of pre-process, sort and rasterize, ms; null where only the whole is known. */
  readonly stagesMs: readonly number[] | null;
  /** Largest error of a channel against `reference`, in steps of an 8-bit channel. */
  readonly maxSteps: number;
}

/** Times that differ by less are about the same. */
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
 * What the presets cost, in a sentence or two: the quickest whose picture cannot be told from that
 * of `reference`, and the quickest of all. Null where `reference` was not measured.
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

/** `identical`, `error ≤ 12 of 255`: the same in a table. */
export function errorLabel(maxSteps: number): string {
  const steps = Math.round(maxSteps);
  return steps === 0 ? 'identical' : `error ≤ ${formatCount(steps)} of 255`;
}
