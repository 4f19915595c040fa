import type { AccuracyPoint } from '@websplatter/core/measure';
import type { LabelBox } from './place-labels.ts';

/** A place in a chart, in pixels, y down. */
export interface ChartPlace {
  readonly x: number;
  readonly y: number;
}

/** A point of a table in its chart. */
export interface PlacedPoint extends ChartPlace {
  readonly point: AccuracyPoint;
  /** Its place in the table. */
  readonly index: number;
  /** Ends of the interval of its median time. */
  readonly lowX: number;
  readonly highX: number;
}

/** A round value of an axis. */
export interface ChartTick {
  /** Its x or y. */
  readonly at: number;
  readonly text: string;
}

/** Error over time: accurate up, fast left. Lengths are in pixels. */
export interface ErrorTimeChart {
  /** In order of time. */
  readonly points: readonly PlacedPoint[];
  /**
   * Corners of a line of steps: the least error for each time. It rises from the bottom at the
   * fastest point and goes on to the right edge after the most accurate one. Empty without points.
   */
  readonly front: readonly ChartPlace[];
  /** Boxes around the lines of the front and of the intervals, which names should not cover. */
  readonly lines: readonly LabelBox[];
  readonly xTicks: readonly ChartTick[];
  readonly yTicks: readonly ChartTick[];
  /** Whether the axis of time is logarithmic. */
  readonly isLogTime: boolean;
  /**
   * Bottom of the band at the top of the chart in whose middle points stand that equal the
   * reference, since they have no error in dB; null if no point does.
   */
  readonly bandBottom: number | null;
}

/** A linear axis of times would crowd the fast points if the slowest takes longer than this. */
const MOST_LINEAR_RATIO = 6;
/** Height of the band, as a part of the range of the other points. */
const BAND_PART = 0.22;
/** Part of the range that is left free at each end. */
const MARGIN = 0.08;

/**
 * Places the points of a table of accuracies in `area`.
 *
 * @param mostTicks how many steps each axis has at most, at least 1.
 */
export function errorTimeChart(
  points: readonly AccuracyPoint[],
  area: LabelBox,
  mostTicks: { readonly x: number; readonly y: number },
): ErrorTimeChart {
  const { xOf, xTicks, isLogTime } = timeAxis(points, area, mostTicks.x);
  const { yOf, yTicks, bandBottom } = errorAxis(points, area, mostTicks.y);
  const placed = points
    .map((point, index): PlacedPoint => {
      const { median, low, high } = point.timeMs.total;
      const places = { x: xOf(median), lowX: xOf(low), highX: xOf(high), y: yOf(point.error.psnrDb) };
      return { point, index, ...places };
    })
    .sort((a, b) => a.x - b.x);
  const front = frontLine(
    placed.filter(({ point }) => point.isOnFront),
    area,
  );
  const steps = front.slice(1).flatMap((to, i) => {
    const from = front[i];
    return [lineBox(from, { x: to.x, y: from.y }), lineBox({ x: to.x, y: from.y }, to)];
  });
  const intervals = placed.map(({ lowX, highX, y }) => lineBox({ x: lowX, y }, { x: highX, y }));
  return { points: placed, front, lines: [...steps, ...intervals], xTicks, yTicks, isLogTime, bandBottom };
}

/** @param points in order of time. */
function frontLine(points: readonly PlacedPoint[], { right, bottom }: LabelBox): ChartPlace[] {
  const [first, last] = [points.at(0), points.at(-1)];
  if (!first || !last) return [];
  return [{ x: first.x, y: bottom }, ...points.map(({ x, y }) => ({ x, y })), { x: right, y: last.y }];
}

/** SVG path of the front: flat up to the next corner, then up. @param write writes a coordinate. */
export function frontPath(front: readonly ChartPlace[], write: (px: number) => number = (px) => px): string {
  return front
    .map(({ x, y }, i) => (i > 0 ? `H${write(x)}V${write(y)}` : `M${write(x)} ${write(y)}`))
    .join('');
}

/** A box around a horizontal or vertical line. */
function lineBox(from: ChartPlace, to: ChartPlace): LabelBox {
  return {
    left: Math.min(from.x, to.x) - 1,
    top: Math.min(from.y, to.y) - 1,
    right: Math.max(from.x, to.x) + 1,
    bottom: Math.max(from.y, to.y) + 1,
  };
}

function timeAxis(points: readonly AccuracyPoint[], { left, right }: LabelBox, most: number) {
  const times = points.flatMap(({ timeMs: { total } }) => [total.low, total.high]);
  const [low, high] = [Math.min(...times), Math.max(...times)];
  const isLogTime = low > 0 && high / low > MOST_LINEAR_RATIO;
  const project = isLogTime ? Math.log10 : (ms: number) => ms;
  const range = rangeOf(times.map(project), isLogTime ? Number.NEGATIVE_INFINITY : 0);
  const xOf = (ms: number) => left + ((project(ms) - range[0]) / (range[1] - range[0])) * (right - left);
  const ticks = isLogTime ? logTicksIn(range, most) : ticksIn(range, most);
  return { xOf, xTicks: ticks.map(({ value, text }) => ({ at: xOf(value), text })), isLogTime };
}

function errorAxis(points: readonly AccuracyPoint[], { top, bottom }: LabelBox, most: number) {
  const decibels = points.map(({ error }) => error.psnrDb);
  const finite = decibels.filter(Number.isFinite);
  const [from, equalFrom] = rangeOf(finite, 0);
  const hasBand = finite.length < decibels.length;
  const bandDb = hasBand ? BAND_PART * (equalFrom - from) : 0;
  const to = equalFrom + bandDb;
  const yOf = (db: number) => {
    const shown = Number.isFinite(db) ? db : equalFrom + bandDb / 2;
    return top + ((to - shown) / (to - from)) * (bottom - top);
  };
  // There are no decibels in the band.
  const ticks = ticksIn([from, to], most).filter(({ value }) => !hasBand || value < equalFrom);
  const yTicks = ticks.map(({ value, text }) => ({ at: yOf(value), text }));
  return { yOf, yTicks, bandBottom: hasBand ? yOf(equalFrom) : null };
}

/** A range around all values, with margins; a single value stands in its middle. */
function rangeOf(values: readonly number[], least: number): readonly [number, number] {
  if (values.length === 0) return [0, 1];
  const [min, max] = [Math.min(...values), Math.max(...values)];
  const margin = max > min ? MARGIN * (max - min) : Math.max(1, 0.1 * max);
  return [Math.max(least, min - margin), max + margin];
}

interface Tick {
  readonly value: number;
  readonly text: string;
}

/**
 * The round values within a range, lowest first, at steps of 1, 2 or 5 times a power of ten, with
 * as many decimals as the step needs.
 *
 * @param range not empty.
 * @param most how many steps the range has at most, at least 1.
 */
export function ticksIn([from, to]: readonly [number, number], most: number): Tick[] {
  const power = Math.floor(Math.log10((to - from) / most));
  const factor = [1, 2, 5].find((each) => (to - from) / (each * 10 ** power) <= most);
  const [step, decimals] = factor
    ? [factor * 10 ** power, Math.max(0, -power)]
    : [10 ** (power + 1), Math.max(0, -power - 1)];
  const first = Math.ceil(from / step);
  const count = Math.max(0, Math.floor(to / step) - first + 1);
  return Array.from({ length: count }, (_, i) => {
    const value = (first + i) * step;
    return { value, text: value.toFixed(decimals) };
  });
}

/** Ticks at 1, 2 and 5 times the powers of ten; at the powers alone if there would be over `most`. */
function logTicksIn([from, to]: readonly [number, number], most: number): Tick[] {
  const first = Math.floor(from);
  const powers = Array.from({ length: Math.floor(to) - first + 1 }, (_, i) => first + i);
  const ticksOf = (factors: readonly number[]) =>
    powers
      .flatMap((power) => factors.map((factor) => Number((factor * 10 ** power).toPrecision(12))))
      .filter((value) => Math.log10(value) >= from && Math.log10(value) <= to)
      .map((value) => ({ value, text: `${value}` }));
  const all = ticksOf([1, 2, 5]);
  return all.length <= most + 1 ? all : ticksOf([1]);
}
