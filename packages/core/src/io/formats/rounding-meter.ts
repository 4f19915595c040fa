import { floatStep } from '../../data/math/float-step.ts';
import { type Harmonics, readCoefficients } from '../../data/packing/harmonics.ts';
import { PositionSample, splatSize } from '../../data/packing/position-sample.ts';
import { coefficientsPerSplat, type SplatColumns, type SplatSet } from '../../data/splats/splat-set.ts';

/** A step is too coarse for a splat if it is longer than this part of the splat's size. */
const MOST_STEP = 1 / 2;
/** Largest change of a log scale that is no loss: a quarter of the size. */
const MOST_LOG_SCALE_ERROR = 1 / 4;
/** Largest change of a base coefficient that is no loss: 0.05 of a colour from 0 to 1. */
const MOST_COLOR_ERROR = 0.18;
/** Harmonics are lost if they change by this part of themselves, and by this much: RMS of coefficients. */
const MOST_SH_ERROR = { part: 1 / 2, rms: 0.02 } as const;
/** A loss is told if any splat loses so many times the most that is no loss. */
const TOLD_EXCESS = 20;
/** Or if multiples of it add up to this part of the number of splats: one of twenty loses that much. */
const TOLD_SHARE = 0.05;

/** Splats that lose something, and how much. */
interface Loss {
  count: number;
  /** Largest change as a multiple of the largest one that is no loss. */
  excess: number;
  /** That change. */
  worst: number;
  /** Sum of such multiples, each up to `TOLD_EXCESS`. */
  sum: number;
}

/** What rounding to the steps of a format does to splats. Can be posted. */
export interface Rounding {
  splats: number;
  /** `worst`: the step, in scene units. */
  readonly positions: Loss;
  /** The same of readers that decode positions in float32. */
  readonly float32Positions: Loss;
  /** `worst`: change of a log scale. */
  readonly scales: Loss;
  /** `worst`: change of a base coefficient. */
  readonly colors: Loss;
  /** Sums of squares of coefficients and of their changes, and the number of coefficients. */
  readonly harmonics: { values: number; changes: number; count: number };
}

const noLoss = (): Loss => ({ count: 0, excess: 0, worst: 0, sum: 0 });

function noRounding(): Rounding {
  return {
    splats: 0,
    positions: noLoss(),
    float32Positions: noLoss(),
    scales: noLoss(),
    colors: noLoss(),
    harmonics: { values: 0, changes: 0, count: 0 },
  };
}

/** Adds the roundings of some splats to those of others. */
export function addRounding(total: Rounding, other: Rounding): void {
  total.splats += other.splats;
  for (const kind of ['positions', 'float32Positions', 'scales', 'colors'] as const) {
    total[kind].count += other[kind].count;
    total[kind].sum += other[kind].sum;
    if (other[kind].excess > total[kind].excess) {
      total[kind].excess = other[kind].excess;
      total[kind].worst = other[kind].worst;
    }
  }
  for (const sum of ['values', 'changes', 'count'] as const) total.harmonics[sum] += other.harmonics[sum];
}

/** Median size of a set's splats: see `splatSize`. */
export function medianSizeOf({ positions, count, logScales }: SplatColumns): number {
  const sample = new PositionSample();
  sample.addAll(positions, count, undefined, 0, logScales);
  return sample.medianSize;
}

/**
 * Measures what rounding to a format's steps does to splats, before they are written. Steps of
 * positions are compared with the size of each splat; of splats that are smaller than most, with the
 * median size, as they are hardly seen.
 */
export class RoundingMeter {
  readonly rounding = noRounding();
  readonly #medianSize: number;
  #values = new Float64Array(0);

  /** @param medianSize of the scene's splats, in scene units. */
  constructor(medianSize: number) {
    this.#medianSize = medianSize;
  }

  /** See `roundingNotes`. */
  notes(advice: RoundingAdvice): string[] {
    return roundingNotes(this.rounding, this.#medianSize, advice);
  }

  /** Adds a splat. @param step longest of the distances between places, along x, y and z, around it. */
  position({ logScales }: SplatColumns, i: number, step: number): void {
    this.rounding.splats++;
    take(this.rounding.positions, step, this.#mostStep(logScales, i));
  }

  /** Adds what readers lose of a position that decode in float32. */
  float32Position({ positions, origin, logScales }: SplatColumns, i: number): void {
    let step = 0;
    for (let axis = 0; axis < 3; axis++) {
      const value = positions[3 * i + axis] + origin[axis];
      if (Math.fround(value) !== value) step = Math.max(step, floatStep(value));
    }
    take(this.rounding.float32Positions, step, this.#mostStep(logScales, i));
  }

  /**
   * Adds the log scales of a splat, of which the smallest, the thickness of a disc, does not count.
   *
   * @param written the log scale that is written of each axis.
   */
  scales({ logScales }: SplatColumns, i: number, written: (axis: number) => number): void {
    const own = [logScales[3 * i], logScales[3 * i + 1], logScales[3 * i + 2]];
    const thinnest = own.indexOf(Math.min(own[0], own[1], own[2]));
    let error = 0;
    for (let axis = 0; axis < 3; axis++)
      if (axis !== thinnest && Number.isFinite(own[axis]))
        error = Math.max(error, Math.abs(written(axis) - own[axis]));
    take(this.rounding.scales, error, MOST_LOG_SCALE_ERROR);
  }

  /** Adds the base colour of a splat. @param written the coefficient that is written of each channel. */
  color({ colorDc }: SplatColumns, i: number, written: (channel: number) => number): void {
    let error = 0;
    for (let k = 0; k < 3; k++) error = Math.max(error, Math.abs(written(k) - colorDc[3 * i + k]));
    take(this.rounding.colors, error, MOST_COLOR_ERROR);
  }

  /** Adds the harmonics of a splat. @param written the coefficient that is written of each. */
  harmonics(
    { harmonics }: SplatSet<Harmonics>,
    i: number,
    written: (value: number, index: number) => number,
  ): void {
    const length = coefficientsPerSplat(harmonics.degree);
    if (this.#values.length !== length) this.#values = new Float64Array(length);
    readCoefficients(harmonics, i, this.#values);
    const sums = this.rounding.harmonics;
    for (let k = 0; k < length; k++) {
      sums.values += this.#values[k] ** 2;
      sums.changes += (written(this.#values[k], k) - this.#values[k]) ** 2;
    }
    sums.count += length;
  }

  #mostStep(logScales: ArrayLike<number>, i: number): number {
    return MOST_STEP * Math.max(splatSize(logScales, 3 * i), this.#medianSize);
  }
}

function take(loss: Loss, change: number, most: number): void {
  // Splats without any size are not seen, and may be anywhere.
  if (!(change > most && most > 0)) return;
  const excess = change / most;
  loss.count++;
  loss.sum += Math.min(excess, TOLD_EXCESS);
  if (excess <= loss.excess) return;
  loss.excess = excess;
  loss.worst = change;
}

/** What a format's notes say of its steps, and what to do. */
export interface RoundingAdvice {
  /** The format's name for people. */
  readonly title: string;
  /** What keeps positions, without a full stop. */
  readonly positions: string;
}

/**
 * Notes about what a format loses of splats: a sentence each, none if nothing is lost that can be
 * seen.
 *
 * @param medianSize of the scene's splats, in scene units.
 */
function roundingNotes(
  { splats, positions, float32Positions, scales, colors, harmonics }: Rounding,
  medianSize: number,
  { title, positions: advice }: RoundingAdvice,
): string[] {
  const notes: string[] = [];
  const isTold = ({ excess, sum }: Loss) => excess > TOLD_EXCESS || sum > TOLD_SHARE * splats;
  const some = ({ count }: Loss) => `${count.toLocaleString('en')} of ${splats.toLocaleString('en')} splats`;
  const size = `the splats' median size is ${short(medianSize)}`;
  if (isTold(positions)) {
    const found = `${title} places ${some(positions)} in steps of up to ${short(positions.worst)}`;
    notes.push(`${found}; ${size}. ${advice}`);
  }
  if (isTold(float32Positions)) {
    const found = `other readers of ${title} place ${some(float32Positions)} in steps of ${short(float32Positions.worst)}, those of float32`;
    notes.push(`${found}; ${size}. Move the scene to 0, or write PLY or glTF`);
  }
  if (isTold(scales)) {
    const factor = short(Math.exp(Math.min(scales.worst, 700)));
    notes.push(
      `${title} changes the sizes of ${some(scales)}, by a factor of up to ${factor}. Scale the scene, or write PLY or glTF`,
    );
  }
  if (isTold(colors)) {
    notes.push(
      `${title} changes the base colours of ${some(colors)}, coefficients by up to ${short(colors.worst)}. Write PLY or glTF to keep them`,
    );
  }
  const [own, change] = [harmonics.values, harmonics.changes].map((sum) => Math.sqrt(sum / harmonics.count));
  if (change > MOST_SH_ERROR.rms && change > MOST_SH_ERROR.part * own) {
    notes.push(
      `${title} changes harmonics by ${short(change)}, as RMS of coefficients, and they are ${short(own)}. Write PLY or glTF to keep them`,
    );
  }
  return notes;
}

function short(value: number): string {
  return String(Number(value.toPrecision(2)));
}
