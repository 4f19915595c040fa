/** Surfaces that can be covered evenly with splats, and the even covering. */
import { clamp01 } from './noise.ts';

/** The fraction that multiples of spread most evenly modulo 1. */
export const GOLDEN_RATIO_CONJUGATE = (Math.sqrt(5) - 1) / 2;

/** A point on a surface; one object is reused for all points of a surface. Metres. */
export class SurfacePoint {
  x = 0;
  y = 0;
  z = 0;
  /** Unit normal, outwards. */
  normalX = 0;
  normalY = 1;
  normalZ = 0;
  /** Position in the object's own frame, where its patterns live. */
  localX = 0;
  localY = 0;
  localZ = 0;
  /** Distance between neighbouring splats at full coverage: the square root of the area of each. */
  spacing = 0;
}

/**
 * A surface parametrised by the unit square such that equal areas of the square cover equal areas of the surface (or
 * `areaAt` of it). The golden-ratio lattice used in the square stays even under any stretching along u and v, because
 * no ratio is further from all fractions; so nothing else is asked of the parametrisation.
 */
export interface Surface {
  /** Metres squared. */
  readonly area: number;
  /** Writes position, normal and local position; returns the area that the unit square's area maps to here. */
  sample(u: number, v: number, point: SurfacePoint): number;
}

/** Point `index` of `count` of the even covering of a surface. */
export function sampleLattice(surface: Surface, index: number, count: number, point: SurfacePoint): void {
  const u = (index + 0.5) / count;
  const v = (index * GOLDEN_RATIO_CONJUGATE) % 1;
  const area = surface.sample(u, v, point);
  point.spacing = Math.sqrt(area / count);
}

/** A profile of (radius, height) points, in metres, turned about the y axis. */
export type Profile = readonly (readonly [radius: number, height: number])[];

/** Segments per span of a profile: enough that a fruit's outline is smooth in a close-up. */
const SEGMENTS_PER_SPAN = 16;

/** A Catmull–Rom curve through the profile's points as radius, height pairs. */
function smoothProfile(profile: Profile): Float64Array {
  const spans = profile.length - 1;
  const curve = new Float64Array(2 * (spans * SEGMENTS_PER_SPAN + 1));
  for (let i = 0; i <= spans * SEGMENTS_PER_SPAN; i++) {
    const span = Math.min(Math.floor(i / SEGMENTS_PER_SPAN), spans - 1);
    const t = i / SEGMENTS_PER_SPAN - span;
    const p0 = profile[Math.max(span - 1, 0)];
    const p1 = profile[span];
    const p2 = profile[span + 1];
    const p3 = profile[Math.min(span + 2, spans)];
    for (let k = 0; k < 2; k++) {
      curve[2 * i + k] =
        p1[k] +
        0.5 *
          t *
          (p2[k] -
            p0[k] +
            t * (2 * p0[k] - 5 * p1[k] + 4 * p2[k] - p3[k] + t * (3 * (p1[k] - p2[k]) + p3[k] - p0[k])));
    }
    curve[2 * i] = Math.max(curve[2 * i], 0);
  }
  return curve;
}

/**
 * A surface of revolution about the y axis. The profile runs with the outside on its right: upwards along an outer
 * wall, downwards along an inner one.
 */
export class TurnedSurface implements Surface {
  readonly area: number;
  readonly #curve: Float64Array;
  readonly #cumulative: Float64Array;
  /** Unit normal (radial, vertical) at each point of the curve. */
  readonly #normals: Float64Array;

  constructor(profile: Profile) {
    const curve = smoothProfile(profile);
    const points = curve.length / 2;
    const cumulative = new Float64Array(points);
    const normals = new Float64Array(2 * points);
    for (let i = 1; i < points; i++) {
      const dr = curve[2 * i] - curve[2 * i - 2];
      const dy = curve[2 * i + 1] - curve[2 * i - 1];
      // The lateral area of a truncated cone.
      cumulative[i] = cumulative[i - 1] + Math.PI * (curve[2 * i] + curve[2 * i - 2]) * Math.hypot(dr, dy);
    }
    for (let i = 0; i < points; i++) {
      const before = Math.max(i - 1, 0);
      const after = Math.min(i + 1, points - 1);
      const dr = curve[2 * after] - curve[2 * before];
      const dy = curve[2 * after + 1] - curve[2 * before + 1];
      const length = Math.hypot(dr, dy) || 1;
      normals[2 * i] = dy / length;
      normals[2 * i + 1] = -dr / length;
    }
    this.#curve = curve;
    this.#cumulative = cumulative;
    this.#normals = normals;
    this.area = cumulative[points - 1];
  }

  sample(u: number, v: number, point: SurfacePoint): number {
    const cumulative = this.#cumulative;
    const target = u * this.area;
    let low = 0;
    let high = cumulative.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (cumulative[middle] <= target) low = middle;
      else high = middle;
    }
    const t = clamp01((target - cumulative[low]) / (cumulative[high] - cumulative[low] || 1));
    const curve = this.#curve;
    const normals = this.#normals;
    const radius = curve[2 * low] + t * (curve[2 * high] - curve[2 * low]);
    const height = curve[2 * low + 1] + t * (curve[2 * high + 1] - curve[2 * low + 1]);
    const radial = normals[2 * low] + t * (normals[2 * high] - normals[2 * low]);
    const vertical = normals[2 * low + 1] + t * (normals[2 * high + 1] - normals[2 * low + 1]);
    const length = Math.hypot(radial, vertical) || 1;
    const cos = Math.cos(2 * Math.PI * v);
    const sin = Math.sin(2 * Math.PI * v);
    point.x = radius * cos;
    point.y = height;
    point.z = radius * sin;
    point.normalX = (radial / length) * cos;
    point.normalY = vertical / length;
    point.normalZ = (radial / length) * sin;
    point.localX = point.x;
    point.localY = point.y;
    point.localZ = point.z;
    return this.area;
  }

  /** The largest radius at each of `count` evenly spaced heights, for a shadow's stand-in; and the height range. */
  silhouette(count: number): { bottomY: number; topY: number; radii: Float64Array } {
    const curve = this.#curve;
    let bottomY = Infinity;
    let topY = -Infinity;
    for (let i = 1; i < curve.length; i += 2) {
      bottomY = Math.min(bottomY, curve[i]);
      topY = Math.max(topY, curve[i]);
    }
    const radii = new Float64Array(count);
    for (let i = 0; i < curve.length - 2; i += 2) {
      const steps = 8;
      for (let step = 0; step <= steps; step++) {
        const t = step / steps;
        const y = curve[i + 1] + t * (curve[i + 3] - curve[i + 1]);
        const place = Math.round(((y - bottomY) / (topY - bottomY)) * (count - 1));
        radii[place] = Math.max(radii[place], curve[i] + t * (curve[i + 2] - curve[i]));
      }
    }
    return { bottomY, topY, radii };
  }
}

/** A horizontal disc facing up at y = 0, parametrised by chords so that its splats may be stretched along x or z. */
export class DiscSurface implements Surface {
  readonly area: number;
  readonly #radius: number;

  constructor(radius: number) {
    this.#radius = radius;
    this.area = Math.PI * radius * radius;
  }

  sample(u: number, v: number, point: SurfacePoint): number {
    // Share of a unit disc's area left of x = sin(angle): 1/2 + (angle + sin·cos)/π; inverted by Newton's method.
    const target = Math.PI * (u - 0.5);
    let angle = target * 0.6;
    for (let iteration = 0; iteration < 12; iteration++) {
      const slope = 2 * Math.cos(angle) ** 2;
      if (slope < 1e-4) break;
      const step = (angle + 0.5 * Math.sin(2 * angle) - target) / slope;
      angle = Math.max(-1.57, Math.min(1.57, angle - step));
    }
    const halfChord = this.#radius * Math.cos(angle);
    point.x = this.#radius * Math.sin(angle);
    point.y = 0;
    point.z = halfChord * (2 * v - 1);
    point.normalX = 0;
    point.normalY = 1;
    point.normalZ = 0;
    point.localX = point.x;
    point.localY = 0;
    point.localZ = point.z;
    return this.area;
  }
}

/** A rectangle [-width/2, width/2] × [-length/2, length/2] bent into shape by `place`. */
export class BentSheet implements Surface {
  readonly area: number;
  readonly #width: number;
  readonly #length: number;
  readonly #place: (a: number, b: number, out: Float64Array) => void;
  readonly #here = new Float64Array(3);
  readonly #right = new Float64Array(3);
  readonly #ahead = new Float64Array(3);

  /** @param place writes the position of the sheet's point (a, b), in metres */
  constructor(width: number, length: number, place: (a: number, b: number, out: Float64Array) => void) {
    this.#width = width;
    this.#length = length;
    this.#place = place;
    this.area = width * length;
  }

  sample(u: number, v: number, point: SurfacePoint): number {
    // Half a millimetre: below any fold, far above rounding.
    const step = 5e-4;
    const a = this.#width * (v - 0.5);
    const b = this.#length * (u - 0.5);
    const here = this.#here;
    const right = this.#right;
    const ahead = this.#ahead;
    this.#place(a, b, here);
    this.#place(a + step, b, right);
    this.#place(a, b + step, ahead);
    for (let k = 0; k < 3; k++) {
      right[k] = (right[k] - here[k]) / step;
      ahead[k] = (ahead[k] - here[k]) / step;
    }
    const x = ahead[1] * right[2] - ahead[2] * right[1];
    const y = ahead[2] * right[0] - ahead[0] * right[2];
    const z = ahead[0] * right[1] - ahead[1] * right[0];
    const length = Math.hypot(x, y, z) || 1;
    point.x = here[0];
    point.y = here[1];
    point.z = here[2];
    point.normalX = x / length;
    point.normalY = y / length;
    point.normalZ = z / length;
    point.localX = a;
    point.localY = 0;
    point.localZ = b;
    return this.area * length;
  }
}

/**
 * Splits `total` into whole parts in proportion to `weights`, every part at least `minimum`, by largest remainders, so
 * that the parts add up exactly.
 */
export function apportion(total: number, weights: readonly number[], minimum: number): number[] {
  const sum = weights.reduce((a, b) => a + b, 0);
  const spare = total - minimum * weights.length;
  const exact = weights.map((weight) => (spare * weight) / sum);
  const counts = exact.map((value) => Math.floor(value));
  let left = spare - counts.reduce((a, b) => a + b, 0);
  const byRemainder = exact.map((value, index) => ({ remainder: value - Math.floor(value), index }));
  byRemainder.sort((a, b) => b.remainder - a.remainder || a.index - b.index);
  for (const { index } of byRemainder) {
    if (left-- <= 0) break;
    counts[index]++;
  }
  return counts.map((count) => count + minimum);
}
