import { ACCURACY_PRESETS } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { describeMeasured } from '../ui/accuracy-words.ts';
import { formatMs, formatPsnr } from '../ui/format.ts';

/** A point of the chart. */
export interface PlacedPoint {
  /** Its place in the table. */
  readonly index: number;
  /** As the engine calls it. */
  readonly name: string;
  /** In plain words. */
  readonly label: string;
  readonly xMs: number;
  /** Interval of the median. */
  readonly lowMs: number;
  readonly highMs: number;
  /** Finite: points whose images equal the reference stand in the middle of the band. */
  readonly yDb: number;
  readonly isOnFront: boolean;
  /** Labels of more important points are placed first. */
  readonly importance: number;
  /** Its figures, for people. */
  readonly words: string;
}

export interface ChartLayout {
  /** In order of time. */
  readonly placed: readonly PlacedPoint[];
  /** The least error for each frame time: corners of a line of steps through the front. */
  readonly frontLine: readonly Pick<PlacedPoint, 'xMs' | 'yDb'>[];
  readonly xRange: readonly [number, number];
  readonly yRange: readonly [number, number];
  /** Start of the band of points that equal the reference, up to the range's end; null for none. */
  readonly equalFromDb: number | null;
}

/** Of the range of the other points, the height of the band of those that equal the reference. */
const BAND_PART = 0.22;
/** Parts of the range left free at its ends. */
const MARGIN = 0.08;

/** Places the points of a table in its chart. */
export function chartLayout(points: readonly AccuracyPoint[]): ChartLayout {
  const decibels = points.map(({ error }) => error.psnrDb);
  const finiteRange = rangeOf(decibels.filter(Number.isFinite));
  const equalFromDb = decibels.every(Number.isFinite) ? null : finiteRange[1];
  const bandDb = equalFromDb === null ? 0 : BAND_PART * (finiteRange[1] - finiteRange[0]);
  const placed = points
    .map((point, index): PlacedPoint => {
      const { name, error, timeMs, isOnFront } = point;
      const isEqual = !Number.isFinite(error.psnrDb);
      const isPreset = Object.hasOwn(ACCURACY_PRESETS, name);
      return {
        index,
        name,
        label: describeMeasured(point),
        xMs: timeMs.total.median,
        lowMs: timeMs.total.low,
        highMs: timeMs.total.high,
        yDb: isEqual ? finiteRange[1] + bandDb / 2 : error.psnrDb,
        isOnFront,
        importance: (isPreset ? 2 : 0) + (isOnFront ? 1 : 0),
        words: `${formatPsnr(error.psnrDb)}, ${formatMs(timeMs.total.median)} ms`,
      };
    })
    .sort((a, b) => a.xMs - b.xMs);
  const xRange = rangeOf(placed.map(({ xMs }) => xMs));
  const yRange = [finiteRange[0], finiteRange[1] + bandDb] as const;
  const front = placed.filter(({ isOnFront }) => isOnFront);
  return { placed, frontLine: frontLine(front, xRange[1], yRange[0]), xRange, yRange, equalFromDb };
}

/** @param front in order of time. No time is below its first point, no accuracy beyond its last. */
function frontLine(front: readonly PlacedPoint[], endMs: number, bottomDb: number): ChartLayout['frontLine'] {
  const [first, last] = [front.at(0), front.at(-1)];
  if (!first || !last) return [];
  return [{ xMs: first.xMs, yDb: bottomDb }, ...front, { xMs: endMs, yDb: last.yDb }];
}

function rangeOf(values: readonly number[]): readonly [number, number] {
  if (values.length === 0) return [0, 1];
  const [min, max] = [Math.min(...values), Math.max(...values)];
  // A single value stands in the middle of a range around it.
  const margin = max > min ? MARGIN * (max - min) : Math.max(1, 0.1 * max);
  return [Math.max(0, min - margin), max + margin];
}
