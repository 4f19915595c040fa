import { floatStep } from '../../../data/math/float-step.ts';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { PositionSample, splatSize } from '../../../data/packing/position-sample.ts';
import { coefficientsPerSplat, type SplatColumns, type SplatSet } from '../../../data/splats/splat-set.ts';

/** A position step is too coarse if it exceeds this fraction of the splat's size. */
const MOST_STEP = 1 / 2;
/** Largest harmless change of a log scale: a quarter of the size. */
const MOST_LOG_SCALE_ERROR = 1 / 4;
/** Largest harmless change of a base coefficient: 0.05 of a colour from 0 to 1. */
const MOST_COLOR_ERROR = 0.18;
/**
 * Harmonics are lost if the RMS of their changes exceeds both this fraction of their RMS and this
 * amount.
 */
const MOST_SH_ERROR = { part: 1 / 2, rms: 0.02 } as const;
/** A note is made if any splat exceeds the harmless change by this factor. */
const TOLD_EXCESS = 20;
/** A note is also made if the excess factors add up to this fraction of the splat count. */
const TOLD_SHARE = 0.05;

/** Number of affected splats, and extent of their losses. */
interface Loss {
  count: number;
  /** Largest change, as a multiple of the largest harmless change. */
  excess: number;
  /** Largest change, in its own unit. */
  worst: number;
  /** Sum of these multiples, each clamped to `TOLD_EXCESS`. */
  sum: number;
}

/** Losses by the rounding steps of a format. Can be posted to another thread. */
export interface Rounding {
  splats: number;
  /** `worst`: the step, in scene units. */
  readonly positions: Loss;
  /** As `positions`, for readers that decode positions in float32. */
  readonly float32Positions: Loss;
  /** `worst`: change of a log scale. */
  readonly scales: Loss;
  /** `worst`: change of a base coefficient. */
  readonly colors: Loss;
  /** Sum of squared coefficients, sum of squared changes, and the number of coefficients. */
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

/** Adds the losses of some splats to a total. */
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
 * Measures the losses by a format's rounding steps, before the splats are written. Position steps
 * are compared with the size of each splat. For a splat below the median size, they are compared
 * with the median, because such a splat is hardly visible.
 */
export class RoundingMeter {
  readonly rounding = noRounding();
  readonly #medianSize: number;
  #values = new Float64Array(0);

  /** @param medianSize median size of the scene's splats, in scene units. */
  constructor(medianSize: number) {
    this.#medianSize = medianSize;
  }

  /** See `roundingNotes`. */
  notes(advice: RoundingAdvice): string[] {
    return roundingNotes(this.rounding, this.#medianSize, advice);
  }

  /**
   * Adds the position of a splat. @param step longest quantisation step around it, along x, y or z,
   * in scene units.
   */
  position({ logScales }: SplatColumns, i: number, step: number): void {
    this.rounding.splats++;
    take(this.rounding.positions, step, this.#mostStep(logScales, i));
  }

  /** Adds the loss of a position in readers that decode it in float32. */
  float32Position({ positions, origin, logScales }: SplatColumns, i: number): void {
    let step = 0;
    for (let axis = 0; axis < 3; axis++) {
      const value = positions[3 * i + axis] + origin[axis];
      if (Math.fround(value) !== value) step = Math.max(step, floatStep(value));
    }
    take(this.rounding.float32Positions, step, this.#mostStep(logScales, i));
  }

  /**
   * Adds the log scales of a splat, except the smallest: the thickness of a disc is not visible.
   *
   * @param written returns the encoded log scale of an axis.
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

  /** Adds the base colour of a splat. @param written returns the encoded coefficient of a channel. */
  color({ colorDc }: SplatColumns, i: number, written: (channel: number) => number): void {
    let error = 0;
    for (let k = 0; k < 3; k++) error = Math.max(error, Math.abs(written(k) - colorDc[3 * i + k]));
    take(this.rounding.colors, error, MOST_COLOR_ERROR);
  }

  /** Adds the harmonics of a splat. @param written returns the encoded coefficient of an index. */
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
  // Splats of size 0 are invisible, so their position does not matter.
  if (!(change > most && most > 0)) return;
  const excess = change / most;
  loss.count++;
  loss.sum += Math.min(excess, TOLD_EXCESS);
  if (excess <= loss.excess) return;
  loss.excess = excess;
  loss.worst = change;
}

/** Wording of a format's notes about rounding. */
export interface RoundingAdvice {
  /** The format's display name. */
  readonly title: string;
  /** Advice for precise positions, without a full stop. */
  readonly positions: string;
}

/**
 * Notes about visible losses of a format, one sentence each; empty if there are none.
 *
 * @param medianSize median size of the scene's splats, in scene units.
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
