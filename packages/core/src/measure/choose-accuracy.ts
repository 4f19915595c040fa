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

/** Settings that were chosen by what they were measured to do. */
export interface AccuracyChoice {
  readonly wish: AccuracyWish;
  readonly settings: AccuracySettings;
  readonly isMet: boolean;
  /** What was chosen and why, in plain words. */
  readonly why: string;
  readonly point: AccuracyPoint;
  readonly table: AccuracyTable;
}

/** A choice that was made stays while it passes the wished time by no more than this part. */
const KEPT_OVERRUN = 0.05;

/**
 * Measures, and takes the settings that meet the wish: of those that are accurate enough the fastest, of those that are
 * fast enough the most accurate. Where none meets it, the closest.
 *
 * @param options as for `measureAccuracy`: with `sampleCameras` the wish is met from all sides, since the worst camera
 * counts. `previous`: what was chosen before; it stays where the measurement cannot tell that another is better.
 * @throws InvalidArgumentError for a wish that is no positive number; what `measureAccuracy` throws.
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
 * What `chooseAccuracy` does once it has measured.
 *
 * @param previous what was chosen before, if it is not to change without a reason that was measured.
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
  // A time has to be met by all of its interval: by the median alone every other measurement would say otherwise.
  return 'minPsnrDb' in wish ? error.psnrDb >= wish.minPsnrDb : timeMs.total.high <= wish.maxFrameMs;
}

/** The points that come nearest to the wish. */
function closest(points: readonly AccuracyPoint[], wish: AccuracyWish): AccuracyPoint[] {
  if ('maxFrameMs' in wish) return indistinguishable(points);
  const highest = Math.max(...points.map(({ error }) => error.psnrDb));
  return points.filter(({ error }) => error.psnrDb === highest);
}

/** Of the fastest, as far as times can be told apart, the most accurate: errors are the same in every measurement. */
function fastest(points: readonly AccuracyPoint[]): AccuracyPoint {
  return mostAccurate(indistinguishable(points));
}

/** The fastest point and all whose time cannot be told from its. */
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

/** Whether what was chosen before is not measurably worse than what is best now. */
function mayStay(before: AccuracyPoint, best: AccuracyPoint, wish: AccuracyWish, isMet: boolean): boolean {
  const [then, now] = [before.timeMs.total, best.timeMs.total];
  if (!overlap(then, now)) return false;
  if ('minPsnrDb' in wish) return isMet ? meets(before, wish) : before.error.psnrDb === best.error.psnrDb;
  // As accurate as the best, or more so and only just too slow.
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
      ? 'the picture of the reference itself'
      : `${error.psnrDb.toFixed(1)} dB`;
  const result = `${decibels} in ${milliseconds(timeMs.total.median)}`;
  const goal =
    'minPsnrDb' in wish ? `reach ${wish.minPsnrDb} dB` : `stay within ${milliseconds(wish.maxFrameMs)}`;
  const superlative = 'minPsnrDb' in wish ? 'fastest' : 'most accurate';
  if (!isMet) {
    const rivals = `None of the ${count} settings measured can ${goal}`;
    return `${rivals}; “${name}” comes closest with ${result}.`;
  }
  if (isKept) return `“${name}” stays: ${result}, and nothing that was measured is clearly better.`;
  return `“${name}” is the ${superlative} of ${count} settings measured that ${goal}: ${result}.`;
}

function milliseconds(ms: number): string {
  return `${Number(ms.toPrecision(3))} ms`;
}
