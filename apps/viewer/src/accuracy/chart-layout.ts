import { boxAround, type LabelBox, LabelSpace } from '@websplatter/charts';
import { ACCURACY_PRESETS } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { describeMeasured } from '../ui/accuracy-words.ts';
import { formatMs, formatPsnr } from '../ui/format.ts';

/** A point of the chart. */
export interface PlacedPoint {
  /** Index in the table. */
  readonly index: number;
  /** The engine's name for the point. */
  readonly name: string;
  /** The name in plain words. */
  readonly label: string;
  readonly xMs: number;
  /** Confidence interval of the median. */
  readonly lowMs: number;
  readonly highMs: number;
  /** Finite: points whose images equal the reference are in the middle of the band. */
  readonly yDb: number;
  readonly isOnFront: boolean;
  /** Labels of points with a higher importance are placed first. */
  readonly importance: number;
  /** PSNR and time as text, for screen readers. */
  readonly words: string;
}

export interface ChartLayout {
  /** In order of time. */
  readonly placed: readonly PlacedPoint[];
  /** Corners of a step line with the least error for each frame time. */
  readonly frontLine: readonly Pick<PlacedPoint, 'xMs' | 'yDb'>[];
  readonly xRange: readonly [number, number];
  readonly yRange: readonly [number, number];
  /**
   * Start of the band for points that equal the reference; it reaches to the range's end. Null if
   * there are none.
   */
  readonly equalFromDb: number | null;
}

/**
 * Height of the band for points that equal the reference, as a fraction of the other points' range.
 */
const BAND_PART = 0.22;
/** Fractions of the range left free at its ends. */
const MARGIN = 0.08;

/** Computes positions and ranges for the chart of a table. */
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

/**
 * @param front in order of time. Nothing is faster than its first point or more accurate than its
 * last.
 */
function frontLine(front: readonly PlacedPoint[], endMs: number, bottomDb: number): ChartLayout['frontLine'] {
  const [first, last] = [front.at(0), front.at(-1)];
  if (!first || !last) return [];
  return [{ xMs: first.xMs, yDb: bottomDb }, ...front, { xMs: endMs, yDb: last.yDb }];
}

function rangeOf(values: readonly number[]): readonly [number, number] {
  if (values.length === 0) return [0, 1];
  const [min, max] = [Math.min(...values), Math.max(...values)];
  // A single value is centred in a range around it.
  const margin = max > min ? MARGIN * (max - min) : Math.max(1, 0.1 * max);
  return [Math.max(0, min - margin), max + margin];
}

/** A rectangle, CSS pixels, y down. */
export interface Box {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

/** A point of a chart that gets a label. */
interface Labelled {
  readonly x: number;
  readonly y: number;
  /** Size of the rendered label. */
  readonly width: number;
  readonly height: number;
}

/** Distance between a point's centre and its label. */
const GAP_PX = 8;
/** Half the width of a point. */
const POINT_PX = 4;

/**
 * Places labels beside their points: right, else left, above or below. They stay inside `area`,
 * clear of other labels and points, and of `lines` if possible. Null for labels without room.
 *
 * @param points the most important first; later ones yield.
 * @param lines bounding boxes of the chart's lines, which would cross labels out.
 */
export function placeLabels(
  points: readonly Labelled[],
  area: Box,
  lines: readonly Box[] = [],
): (Box | null)[] {
  const marks = points.map(({ x, y }) => boxAround(x, y, POINT_PX));
  const space = new LabelSpace(edgesOf(area), marks);
  const lineSpace = new LabelSpace(edgesOf(area), lines.map(edgesOf));
  return points.map((point) => {
    const free = placesFor(point).filter((place) => space.conflict(edgesOf(place)) === 0);
    const box = free.find((place) => lineSpace.conflict(edgesOf(place)) === 0) ?? free.at(0);
    if (box) space.take(edgesOf(box));
    return box ?? null;
  });
}

/** No label touches its own point. */
function placesFor({ x, y, width, height }: Labelled): Box[] {
  const size = { width, height };
  const [middleX, middleY] = [x - width / 2, y - height / 2];
  return [
    { left: x + GAP_PX, top: middleY, ...size },
    { left: x - GAP_PX - width, top: middleY, ...size },
    { left: middleX, top: y - GAP_PX - height, ...size },
    { left: middleX, top: y + GAP_PX, ...size },
    { left: x + GAP_PX / 2, top: y - GAP_PX / 2 - height, ...size },
    { left: x - GAP_PX / 2 - width, top: y + GAP_PX / 2, ...size },
  ];
}

function edgesOf({ left, top, width, height }: Box): LabelBox {
  return { left, top, right: left + width, bottom: top + height };
}

/** A round value on an axis. */
interface Tick {
  readonly value: number;
  readonly text: string;
}

/**
 * The round values in a range, in ascending order, in steps of 1, 2 or 5 times a power of ten.
 * Texts have as many decimals as the step needs.
 *
 * @param range not empty.
 * @param most largest number of steps in the range, at least 1.
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
