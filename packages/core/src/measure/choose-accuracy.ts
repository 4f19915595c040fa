import type { AccuracySettings } from '../accuracy/accuracy.ts';
import { type AccuracyWish, checkWish } from '../accuracy/accuracy-wish.ts';
import {
  type AccuracyPoint,
  type AccuracyTable,
  type MeasureAccuracyOptions,
  measureAccuracy,
} from './measure-accuracy.ts';
import type { MeasuredEngine } from './measured-engine.ts';
import { overlap } from './time-spread.ts';

/** Settings chosen by measurement. */
export interface AccuracyChoice {
  readonly wish: AccuracyWish;
  readonly settings: AccuracySettings;
  readonly isMet: boolean;
  /** A sentence that says which settings were chosen and why. */
  readonly why: string;
  readonly point: AccuracyPoint;
  readonly table: AccuracyTable;
}

/** A previous choice may stay if it exceeds the wished time by no more than this fraction. */
const KEPT_OVERRUN = 0.05;

/**
 * Measures, and chooses the settings that meet the wish: the fastest that are accurate enough, or the most accurate that are
 * fast enough. If none meets it, chooses the closest.
 *
 * @param options as for `measureAccuracy`: with `sampleCameras` the wish is met from all sides, since the worst camera
 * counts. `previous`: the last choice; it stays unless the measurement shows that another is better.
 * @throws InvalidArgumentError for a wish that is no positive number; errors of `measureAccuracy`.
 */
export async function chooseAccuracy(
  engine: MeasuredEngine,
  wish: AccuracyWish,
  options: MeasureAccuracyOptions & { readonly previous?: AccuracyChoice },
): Promise<AccuracyChoice> {
  checkWish(wish);
  return chooseFrom(await measureAccuracy(engine, options), wish, options.previous);
}

/**
 * Chooses settings from a finished measurement, as `chooseAccuracy` does.
 *
 * @param previous the last choice, if it should stay unless the measurement shows that another is better.
 */
export function chooseFrom(
  table: AccuracyTable,
  wish: AccuracyWish,
  previous?: AccuracyChoice,
): AccuracyChoice {
  checkWish(wish);
  const { points } = table;
  const fitting = points.filter((point) => meets(point, wish));
  const isMet = fitting.length > 0;
  const candidates = isMet ? fitting : closest(points, wish);
  const best = 'minPsnrDb' in wish ? fastest(candidates) : mostAccurate(candidates);
  const before = previous && points.find(({ settings }) => settings === previous.settings);
  const isKept = before !== undefined && before !== best && mayStay(before, best, wish, isMet);
  const point = isKept ? before : best;
  const why = sentence(point, wish, isMet, isKept, points.length);
  return { wish, settings: point.settings, isMet, why, point, table };
}

function meets({ error, timeMs }: AccuracyPoint, wish: AccuracyWish): boolean {
  // The whole interval must meet the time: with the median alone, the verdict would flip in every other measurement.
  return 'minPsnrDb' in wish ? error.psnrDb >= wish.minPsnrDb : timeMs.total.high <= wish.maxFrameMs;
}

/** Returns the points nearest to the wish. */
function closest(points: readonly AccuracyPoint[], wish: AccuracyWish): AccuracyPoint[] {
  if ('maxFrameMs' in wish) return indistinguishable(points);
  const highest = Math.max(...points.map(({ error }) => error.psnrDb));
  return points.filter(({ error }) => error.psnrDb === highest);
}

/** Returns the most accurate of the `indistinguishable` points: errors, unlike times, are the same in every measurement. */
function fastest(points: readonly AccuracyPoint[]): AccuracyPoint {
  return mostAccurate(indistinguishable(points));
}

/** Returns the fastest point, and all points whose times cannot be told from its time. */
function indistinguishable(points: readonly AccuracyPoint[]): AccuracyPoint[] {
  const first = points.reduce((best, each) =>
    each.timeMs.total.median < best.timeMs.total.median ? each : best,
  );
  return points.filter(({ timeMs }) => overlap(timeMs.total, first.timeMs.total));
}

function mostAccurate(points: readonly AccuracyPoint[]): AccuracyPoint {
  return points.reduce((best, each) => {
    const isAlike = each.error.psnrDb === best.error.psnrDb;
    const isBetter = isAlike
      ? each.timeMs.total.median < best.timeMs.total.median
      : each.error.psnrDb > best.error.psnrDb;
    return isBetter ? each : best;
  });
}

/** Whether the previous choice is not measurably worse than the best point. */
function mayStay(before: AccuracyPoint, best: AccuracyPoint, wish: AccuracyWish, isMet: boolean): boolean {
  const [then, now] = [before.timeMs.total, best.timeMs.total];
  if (!overlap(then, now)) return false;
  if ('minPsnrDb' in wish) return isMet ? meets(before, wish) : before.error.psnrDb === best.error.psnrDb;
  // It must be at least as accurate as the best, and may be slightly too slow.
  const isFastEnough = !isMet || then.median <= (1 + KEPT_OVERRUN) * wish.maxFrameMs;
  return isFastEnough && before.error.psnrDb >= best.error.psnrDb;
}

function sentence(
  { name, error, timeMs }: AccuracyPoint,
  wish: AccuracyWish,
  isMet: boolean,
  isKept: boolean,
  count: number,
): string {
  const decibels =
    error.psnrDb === Number.POSITIVE_INFINITY
      ? 'the image of the reference itself'
      : `${error.psnrDb.toFixed(1)} dB`;
  const result = `${decibels} in ${milliseconds(timeMs.total.median)}`;
  const goal =
    'minPsnrDb' in wish ? `reach ${wish.minPsnrDb} dB` : `stay within ${milliseconds(wish.maxFrameMs)}`;
  const superlative = 'minPsnrDb' in wish ? 'fastest' : 'most accurate';
  if (!isMet) {
    const rivals = `None of the ${count} settings measured can ${goal}`;
    return `${rivals}; “${name}” comes closest with ${result}.`;
  }
  if (isKept) return `“${name}” stays: ${result}, and no other settings are clearly better.`;
  return `“${name}” is the ${superlative} of ${count} settings measured that ${goal}: ${result}.`;
}

function milliseconds(ms: number): string {
  return `${Number(ms.toPrecision(3))} ms`;
}
