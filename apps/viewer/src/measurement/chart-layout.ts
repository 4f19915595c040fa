import { ACCURACY_PRESETS } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { formatDb, formatMs } from '../words/format.ts';

/** A point of the chart. */
export interface PlacedPoint {
  /** Its place in the table. */
  readonly index: number;
  readonly name: string;
  readonly xMs: number;
  /** Interval of the median. */
  readonly lowMs: number;
  readonly highMs: number;
  /** Finite: images that equal the reference stand above all others. */
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
  /** Points on the front, in order of time. */
  readonly front: readonly PlacedPoint[];
  readonly xRange: readonly [number, number];
  readonly yRange: readonly [number, number];
}

/** How far an image that equals the reference stands above the next. */
const EXACT_ABOVE_DB = 8;
/** Parts of the range left free at its ends. */
const MARGIN = 0.08;

/** Places the points of a table in its chart. */
export function chartLayout(points: readonly AccuracyPoint[]): ChartLayout {
  const finite = points.map(({ error }) => error.psnrDb).filter(Number.isFinite);
  const exactDb = (finite.length > 0 ? Math.max(...finite) : 60) + EXACT_ABOVE_DB;
  const placed = points
    .map((point, index): PlacedPoint => {
      const { name, error, timeMs, isOnFront } = point;
      const isPreset = Object.hasOwn(ACCURACY_PRESETS, name);
      return {
        index,
        name,
        xMs: timeMs.total.median,
        lowMs: timeMs.total.low,
        highMs: timeMs.total.high,
        yDb: Math.min(error.psnrDb, exactDb),
        isOnFront,
        importance: (isPreset ? 2 : 0) + (isOnFront ? 1 : 0),
        words: `${formatDb(error.psnrDb)} dB, ${formatMs(timeMs.total.median)} ms`,
      };
    })
    .sort((a, b) => a.xMs - b.xMs);
  return {
    placed,
    front: placed.filter(({ isOnFront }) => isOnFront),
    xRange: rangeOf(placed.map(({ xMs }) => xMs)),
    yRange: rangeOf(placed.map(({ yDb }) => yDb)),
  };
}

function rangeOf(values: readonly number[]): readonly [number, number] {
  if (values.length === 0) return [0, 1];
  const [min, max] = [Math.min(...values), Math.max(...values)];
  // A single value stands in the middle of a range around it.
  const margin = max > min ? MARGIN * (max - min) : Math.max(1, 0.1 * max);
  return [Math.max(0, min - margin), max + margin];
}
