import { floatStep } from '../../../data/math/float-step.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { selectValue } from '../../../data/math/select-value.ts';
import { centerBounds, emptyBounds } from '../../../data/packing/center-bounds.ts';
import type { Harmonics } from '../../../data/packing/harmonics.ts';
import { chooseOrigin } from '../../../data/packing/origin.ts';
import { PositionSample } from '../../../data/packing/position-sample.ts';
import {
  addDrops,
  type DropCounts,
  type FileFacts,
  type ShDegree,
  type SplatSet,
} from '../../../data/splats/splat-set.ts';
import { type TimeRange, timeRangeOf } from '../../../features/motion/splat-motion.data.ts';

/** Fraction of the splats that `positionStep` covers. */
const BULK = 9 / 10;

/**
 * Running facts about the pieces of a file that have arrived.
 *
 * @example
 * const facts = new PieceFacts();
 * await readSplatPieces(file, {}, async (piece) => facts.add(piece));
 * console.log(`${facts.count} splats of degree ${facts.shDegree}, up to ${facts.bounds.max}`);
 */
export class PieceFacts {
  count = 0;
  shDegree: ShDegree = 0;
  /** See `SplatColumns`. */
  isAntialiased: boolean | undefined;
  fileFacts: FileFacts | undefined;
  /** First and last time of a moving scene; null if the splats stand still. */
  timeRange: TimeRange | null = null;
  readonly dropped: DropCounts = {};
  /** Bounds of the centres in scene space, ±Infinity if there are no splats. */
  readonly bounds = emptyBounds();
  readonly #sample = new PositionSample();
  #isWide = false;

  add(piece: SplatSet<Harmonics>): void {
    const { count, positions, logScales, origin, harmonics, motion } = piece;
    const { dropped, isAntialiased, fileFacts } = piece;
    this.#sample.addAll(positions, count, origin, this.count, logScales);
    this.#isWide ||= origin.some((value) => value !== 0);
    this.count += count;
    this.shDegree = harmonics.degree;
    this.isAntialiased = isAntialiased;
    this.fileFacts = fileFacts;
    if (motion) {
      const [from, to] = timeRangeOf(motion);
      const [first, last] = this.timeRange ?? [from, to];
      this.timeRange = [Math.min(first, from), Math.max(last, to)];
    }
    addDrops(this.dropped, dropped);
    const { min, max } = centerBounds(positions, count);
    for (let axis = 0; axis < 3; axis++) {
      this.bounds.min[axis] = Math.min(this.bounds.min[axis], origin[axis] + min[axis]);
      this.bounds.max[axis] = Math.max(this.bounds.max[axis], origin[axis] + max[axis]);
    }
  }

  /** Origin for positions of all pieces together. */
  get origin(): Vec3 {
    return chooseOrigin(this.#sample.axes, this.bounds, this.#isWide);
  }

  /** Whether a piece has an origin, so its positions may be finer than float32. */
  get isWide(): boolean {
    return this.#isWide;
  }

  /** Median size of the splats, as standard deviation in scene units: see `splatSize`. */
  get medianSize(): number {
    return this.#sample.medianSize;
  }

  /**
   * Distance between neighbouring float32 positions, in scene units; 0 if there are no splats. For
   * nine of ten splats, the distance is at most this long. It is measured at the file's coordinates
   * if all of them are float32 numbers, else relative to `origin`.
   */
  get positionStep(): number {
    const { origin } = this;
    const axes = this.#sample.axes;
    const isFloat32 = axes.every((values) => values.every((value) => Math.fround(value) === value));
    const [x, y, z] = isFloat32 ? axes : axes.map((values, k) => values.map((value) => value - origin[k]));
    const steps = x.map((value, i) => floatStep(Math.max(Math.abs(value), Math.abs(y[i]), Math.abs(z[i]))));
    return steps.length > 0 ? selectValue(steps, Math.ceil(BULK * steps.length) - 1) : 0;
  }
}
