import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import { type AccuracyTarget, checkTarget } from '../data/accuracy/accuracy-target.ts';
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
  readonly target: AccuracyTarget;
  readonly settings: AccuracySettings;
  readonly isMet: boolean;
  /** A sentence that says which settings were chosen and why. */
  readonly why: string;
  readonly point: AccuracyPoint;
  readonly table: AccuracyTable;
}

/**
 * A previous choice may stay if it exceeds the target's time, or the best if nothing meets that, by no
 * more than this fraction.
 */
const KEPT_OVERRUN = 0.05;

/**
 * Measures, and chooses the settings that meet the target: the fastest that are accurate enough, or
 * the most accurate that are fast enough. If none meets it, chooses the closest: the most accurate, or
 * the fastest.
 *
 * @param options as for `measureAccuracy`: with `sampleCameras` the target is met from all sides,
 * since the worst camera counts. `previous`: the last choice; it stays unless the measurement shows
 * that another is better.
 * @throws InvalidArgumentError for a target that is no positive number; errors of
 * `measureAccuracy`.
 * @example
 * const clouds = [{ cloud }];
 * const cameras = sampleCameras(camera, cloud.robustBounds);
 * const options = { clouds, cameras, widthPx, heightPx };
 * const { settings, why } = await chooseAccuracy(engine, { maxFrameMs: 8 }, options);
 * console.log(why);
 * view.render({ camera, clouds, widthPx, heightPx, accuracy: settings });
 */
export async function chooseAccuracy(
  engine: MeasuredEngine,
  target: AccuracyTarget,
  options: MeasureAccuracyOptions & { readonly previous?: AccuracyChoice },
): Promise<AccuracyChoice> {
  checkTarget(target);
  return chooseFrom(await measureAccuracy(engine, options), target, options.previous);
}

/**
 * Chooses settings from a finished measurement, as `chooseAccuracy` does.
 *
 * @param previous the last choice, if it should stay unless the measurement shows a better one.
 * @example
 * const clouds = [{ cloud }];
 * const table = await measureAccuracy(engine, { clouds, cameras: [camera], widthPx, heightPx });
 * const whileMoving = chooseFrom(table, { maxFrameMs: 8 });
 * const atRest = chooseFrom(table, { minPsnrDb: 50 });
 */
export function chooseFrom(
  table: AccuracyTable,
  target: AccuracyTarget,
  previous?: AccuracyChoice,
): AccuracyChoice {
  checkTarget(target);
  // Points of `details` show fewer splats: they are no candidates for settings.
  const points = table.points.filter(({ detail }) => detail === table.detail);
  const fitting = points.filter((point) => meets(point, target));
  const isMet = fitting.length > 0;
  const candidates = isMet ? fitting : closest(points, target);
  const best = 'minPsnrDb' in target ? fastest(candidates) : mostAccurate(candidates);
  const before = previous && points.find(({ settings }) => settings === previous.settings);
  const isKept = before !== undefined && before !== best && mayStay(before, best, target, isMet);
  const point = isKept ? before : best;
  const isFastest = candidates.every(({ timeMs }) => point.timeMs.total.median <= timeMs.total.median);
  const why = sentence(point, target, { isMet, isKept, isFastest, count: points.length });
  return { target, settings: point.settings, isMet, why, point, table };
}

function meets({ error, timeMs }: AccuracyPoint, target: AccuracyTarget): boolean {
  // The whole interval must meet the time: by the median, the verdict would flip half the time.
  return 'minPsnrDb' in target ? error.psnrDb >= target.minPsnrDb : timeMs.total.high <= target.maxFrameMs;
}

/** Returns the points nearest to the target. */
function closest(points: readonly AccuracyPoint[], target: AccuracyTarget): AccuracyPoint[] {
  // Not `indistinguishable` points: they may be slower by the spread of the times.
  if ('maxFrameMs' in target) return [leastMedian(points)];
  const highest = Math.max(...points.map(({ error }) => error.psnrDb));
  return points.filter(({ error }) => error.psnrDb === highest);
}

/** Returns the most accurate `indistinguishable` point: errors, unlike times, do not vary. */
function fastest(points: readonly AccuracyPoint[]): AccuracyPoint {
  return mostAccurate(indistinguishable(points));
}

/** Returns the fastest point, and all points whose time intervals overlap its interval. */
function indistinguishable(points: readonly AccuracyPoint[]): AccuracyPoint[] {
  const first = leastMedian(points);
  return points.filter(({ timeMs }) => overlap(timeMs.total, first.timeMs.total));
}

function leastMedian(points: readonly AccuracyPoint[]): AccuracyPoint {
  return points.reduce((best, each) => (each.timeMs.total.median < best.timeMs.total.median ? each : best));
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
function mayStay(
  before: AccuracyPoint,
  best: AccuracyPoint,
  target: AccuracyTarget,
  isMet: boolean,
): boolean {
  const [then, now] = [before.timeMs.total, best.timeMs.total];
  if (!overlap(then, now)) return false;
  if ('minPsnrDb' in target) return isMet ? meets(before, target) : before.error.psnrDb === best.error.psnrDb;
  // It must be at least as accurate as the best, and may be slightly too slow.
  const allowedMs = isMet ? target.maxFrameMs : now.median;
  const isFastEnough = then.median <= (1 + KEPT_OVERRUN) * allowedMs;
  return isFastEnough && before.error.psnrDb >= best.error.psnrDb;
}

function sentence(
  { name, error, timeMs }: AccuracyPoint,
  target: AccuracyTarget,
  { isMet, isKept, isFastest, count }: Record<'isMet' | 'isKept' | 'isFastest', boolean> & { count: number },
): string {
  const decibels =
    error.psnrDb === Number.POSITIVE_INFINITY
      ? 'an image identical to the reference'
      : `${error.psnrDb.toFixed(1)} dB`;
  const result = `${decibels} in ${milliseconds(timeMs.total.median)}`;
  const goal =
    'minPsnrDb' in target ? `reach ${target.minPsnrDb} dB` : `stay within ${milliseconds(target.maxFrameMs)}`;
  if (!isMet) {
    const rivals = `None of the ${count} settings measured can ${goal}`;
    return `${rivals}; “${name}” comes closest with ${result}.`;
  }
  if (isKept) return `“${name}” stays: ${result}, and no other settings are clearly better.`;
  const among = `Of ${count} settings measured,`;
  if ('maxFrameMs' in target) return `${among} “${name}” is the most accurate to ${goal}: ${result}.`;
  return isFastest
    ? `${among} “${name}” is the fastest to ${goal}: ${result}.`
    : `${among} none can ${goal} measurably faster than “${name}”: ${result}.`;
}

function milliseconds(ms: number): string {
  return `${ms < 99.95 ? Number(ms.toPrecision(3)) : Math.round(ms).toLocaleString('en')} ms`;
}
