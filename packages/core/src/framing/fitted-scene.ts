import type { Vec3 } from '../data/math/mat4.ts';
import { cross, dot, negated, plus, scaled, unit } from '../data/math/vec3.ts';
import type { SceneDetail } from './scene-detail.ts';
import type { TrialShape } from './trial-view.ts';
import { weightedQuantile, weightedQuantiles } from './weighted-quantile.ts';

/** Splats by which distances are fitted. */
const FITTED = 2048;
/** Splats beyond so many times the reach of most detail are no part of an object. */
const STRAY = 3;
/** Nearest camera before an object, which may be a single splat. */
const LEAST_DISTANCE = 1.5;
/** Part of the frame's half width and half height that the fitted splats may fill. */
export const FITTED_PART = 0.88;
/** Elevations, in degrees, from which an upright scene, and a flat one, are seen best. */
const BEST_ELEVATIONS = { upright: 14, flat: 32 } as const;
/** Least height of a camera above splats within `UNDERFOOT` of it, in units of the scene's scale. */
const CLEARANCE = 0.08;
const UNDERFOOT = 0.35;

/** Where cameras have to stand to have a scene in the frame, by a part of its splats. */
export class FittedScene {
  readonly #up: Vec3;
  readonly #shape: TrialShape;
  readonly #count: number;
  readonly #x: Float64Array;
  readonly #y: Float64Array;
  readonly #z: Float64Array;
  readonly #heights: Float64Array;
  /** Without strays. */
  readonly #details: Float64Array;
  readonly #nearDetails: Float64Array;
  readonly #scratch: Float64Array;
  readonly #ones: Float64Array;

  constructor(detail: SceneDetail, up: Vec3, shape: TrialShape) {
    const step = Math.max(1, Math.floor(detail.count / FITTED));
    const count = Math.ceil(detail.count / step);
    const of = (value: (i: number) => number) =>
      Float64Array.from({ length: count }, (_, i) => value(i * step));
    const { x, y, z, details, nearDetails, distances, farReach } = detail;
    this.#up = up;
    this.#shape = shape;
    this.#count = count;
    this.#x = of((i) => x[i]);
    this.#y = of((i) => y[i]);
    this.#z = of((i) => z[i]);
    this.#heights = this.along(up);
    this.#details = of((i) => (distances[i] > STRAY * farReach ? 0 : details[i]));
    this.#nearDetails = of((i) => nearDetails[i]);
    this.#scratch = new Float64Array(count);
    this.#ones = new Float64Array(count).fill(1);
  }

  /** Products of the places of the splats and an axis. */
  along(axis: Vec3): Float64Array {
    return this.#x.map((value, i) => value * axis[0] + this.#y[i] * axis[1] + this.#z[i] * axis[2]);
  }

  /** Range along an axis that leaves out `part` of the near detail at each end. */
  range(axis: Vec3, part: number): readonly [low: number, high: number] {
    const [low, high] = weightedQuantiles(this.along(axis), this.#nearDetails, this.#count, [part, 1 - part]);
    return [low, high];
  }

  /**
   * Elevation from which the scene is seen best, in radians: flat ones from higher up.
   *
   * @param across two axes across up.
   */
  bestElevation(across: readonly Vec3[]): number {
    const [height, ...lengths] = [this.#up, ...across].map((axis) => {
      const [low, high] = this.range(axis, 0.1);
      return high - low;
    });
    const length = Math.max(...lengths);
    const flatness = length > 0 ? Math.min(1, Math.max(0, 1 - (4 * height) / length)) : 0;
    const { upright, flat } = BEST_ELEVATIONS;
    return ((upright + (flat - upright) * flatness) * Math.PI) / 180;
  }

  axes(back: Vec3): { readonly right: Vec3; readonly above: Vec3 } {
    const right = unit(cross(negated(back), this.#up));
    return { right, above: cross(right, negated(back)) };
  }

  /** The distance from the middle of the scene at which nearly all near detail is in the frame. */
  nearDistance(back: Vec3): number {
    return this.#distance(back, this.#nearDetails, 0.95, [0, 0, 0]);
  }

  /** The distance from which this part of the weight about `target` is in the frame. */
  #distance(back: Vec3, weights: Float64Array, part: number, target: Vec3): number {
    const { right, above } = this.axes(back);
    const tangentX = FITTED_PART * this.#shape.tangentX;
    const tangentY = FITTED_PART * this.#shape.tangentY;
    const [x, y, z, scratch] = [this.#x, this.#y, this.#z, this.#scratch];
    const [targetX, targetY, targetZ] = target;
    for (let i = 0; i < this.#count; i++) {
      const dx = x[i] - targetX;
      const dy = y[i] - targetY;
      const dz = z[i] - targetZ;
      const across = Math.abs(dx * right[0] + dy * right[1] + dz * right[2]) / tangentX;
      const along = Math.abs(dx * above[0] + dy * above[1] + dz * above[2]) / tangentY;
      scratch[i] = Math.max(across, along) + dx * back[0] + dy * back[1] + dz * back[2];
    }
    return weightedQuantile(scratch, weights, this.#count, part);
  }

  /** The target and distance that show the whole scene in the middle of the picture. */
  whole(back: Vec3): { readonly target: Vec3; readonly distance: number } {
    const [x, y, z, details, scratch] = [this.#x, this.#y, this.#z, this.#details, this.#scratch];
    const { right, above } = this.axes(back);
    for (let i = 0; i < this.#count; i++) scratch[i] = x[i] * back[0] + y[i] * back[1] + z[i] * back[2];
    let target = scaled(back, this.#middleOf(0.01));
    let distance = Math.max(LEAST_DISTANCE, this.#distance(back, details, 0.99, target));
    for (let step = 0; step < 2; step++) {
      for (const axis of [right, above]) {
        const [targetX, targetY, targetZ] = target;
        for (let i = 0; i < this.#count; i++) {
          const dx = x[i] - targetX;
          const dy = y[i] - targetY;
          const dz = z[i] - targetZ;
          const depth = Math.max(distance - (dx * back[0] + dy * back[1] + dz * back[2]), 0.05 * distance);
          scratch[i] = (dx * axis[0] + dy * axis[1] + dz * axis[2]) / depth;
        }
        target = plus(target, axis, this.#middleOf(0.005) * distance);
      }
      distance = Math.max(LEAST_DISTANCE, 1.03 * this.#distance(back, details, 0.997, target));
    }
    return { target, distance };
  }

  /** Middle between the quantiles `part` and 1 − `part` of the detail's coordinates in `#scratch`. */
  #middleOf(part: number): number {
    const [low, high] = weightedQuantiles(this.#scratch, this.#details, this.#count, [part, 1 - part]);
    return (low + high) / 2;
  }

  /** Whether a camera at `position` is above the ground around it. */
  isAboveGround(position: Vec3): boolean {
    const height = dot(position, this.#up);
    const [x, y, z, scratch] = [this.#x, this.#y, this.#z, this.#scratch];
    let found = 0;
    for (let i = 0; i < this.#count; i++) {
      if (this.#details[i] < 0.1) continue;
      const dx = x[i] - position[0];
      const dy = y[i] - position[1];
      const dz = z[i] - position[2];
      const dh = this.#heights[i] - height;
      if (dx * dx + dy * dy + dz * dz - dh * dh > UNDERFOOT * UNDERFOOT) continue;
      scratch[found++] = this.#heights[i];
    }
    if (found < 3) return true;
    return height > weightedQuantile(scratch, this.#ones, found, 0.15) + CLEARANCE;
  }
}
