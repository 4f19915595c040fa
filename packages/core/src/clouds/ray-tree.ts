import type { Vec3 } from '../math/mat4.ts';
import {
  ARITY,
  BLOB_VALUES,
  CORRELATION_STEPS,
  CORRELATION_ZERO,
  DEVIATION_STEPS,
  DEVIATION_ZERO,
  MEAN_STEPS,
  type RayBlobs,
} from './arrange-blobs.ts';
import { MOST_OPACITY } from './ray-blobs.ts';

/** Where a ray meets a cloud. */
export interface RayHit {
  /** In units of the direction's length. */
  readonly distance: number;
  readonly point: Vec3;
}

export interface RayOptions {
  /** Splats nearer than this are passed; in units of the direction's length, default 0. */
  readonly near?: number;
  /** Splats farther away than this are not reached; in units of the direction's length, default Infinity. */
  readonly far?: number;
  /** Least opacity of what a ray hits, 0…1; default 0.3. */
  readonly minOpacity?: number;
  /** Multiplies every splat's opacity, 0…1; default 1. */
  readonly opacity?: number;
  /** Returns what part of its opacity a splat at this point has, 0…1: 0 where it is cut off. Default all. */
  readonly shownAt?: (x: number, y: number, z: number) => number;
}

const DEFAULT_MIN_OPACITY = 0.3;
/** Opacity of a splat is limited to this when it is drawn. */
const MOST_ALPHA = 0.99;
/** Blobs contribute no less. */
const LEAST_ALPHA = 0.01;
/** Squared standard deviations at which the most opaque blob contributes less. */
const MOST_SQUARED = 2 * Math.log(MOST_OPACITY / LEAST_ALPHA);
/** A ray that begins within so many standard deviations of a blob is inside of it, and begins outside. */
const INSIDE_DEVIATIONS = 2;
/**
 * Variance that drawing adds to each splat, 0.3 px², for an image of about 1,000 pixels' height under a field of view of 50
 * degrees: the square of what a pixel's angle is then.
 */
const DILATION = 0.3 * 0.000_93 ** 2;
/** Boxes are met this part of their distance early, for the same reason. */
const BOX_SLACK = 3 * Math.sqrt(DILATION);

/**
 * What rays are tested against in place of a cloud's splats: blobs that each stand for some neighbouring splats, 32,768
 * of them or one for 32 splats, if that is more, and a tree of boxes around them: 770 kB for up to a million splats.
 */
export class RayTree {
  /** @internal */
  readonly origin: Vec3;
  /** Memory that the tree takes. */
  readonly bytes: number;
  readonly #blobs: RayBlobs;
  /** Boxes of each level, the blobs' nodes first. */
  readonly #levels: readonly Float32Array[];

  /** @internal Positions of the blobs are relative to `origin`. */
  constructor(origin: Vec3, blobs: RayBlobs) {
    this.origin = origin;
    this.#blobs = blobs;
    const levels = [blobs.boxes];
    while (levels[levels.length - 1].length > 6) levels.push(parentsOf(levels[levels.length - 1]));
    this.#levels = levels;
    this.bytes = levels.reduce((sum, { byteLength }) => sum + byteLength, blobs.values.byteLength);
  }

  /** Number of blobs. */
  get count(): number {
    return this.#blobs.count;
  }

  /**
   * Returns where a ray in the cloud's own space meets splats: at the depth of those that contribute most to what is seen along
   * it, as `pick` does. Splats that the ray begins inside of are left out. Takes some microseconds, and waits for nothing.
   *
   * @param direction vector of any length but 0.
   * @returns null if all splats on the ray together have less than `minOpacity`, or the ray is not finite.
   */
  cast(origin: Vec3, direction: Vec3, options: RayOptions = {}): RayHit | null {
    const { near = 0, far = Number.POSITIVE_INFINITY, minOpacity = DEFAULT_MIN_OPACITY } = options;
    const length = Math.hypot(...direction);
    if (!(length > 0 && length < Number.POSITIVE_INFINITY) || !origin.every(Number.isFinite)) return null;
    const ray = [
      ...origin.map((value, axis) => value - this.origin[axis]),
      ...direction.map((value) => value / length),
    ];
    const range = [near * length, far * length] as const;
    const walk = new Walk(this.#blobs, this.#levels, ray, options, range);
    const found = walk.run(Math.max(minOpacity, LEAST_ALPHA));
    if (found === null) return null;
    const distance = found / length;
    const along = (axis: number) => origin[axis] + distance * direction[axis];
    return { distance, point: [along(0), along(1), along(2)] };
  }
}

/** Boxes around runs of ARITY boxes. */
function parentsOf(boxes: Float32Array): Float32Array {
  const parents = new Float32Array(6 * Math.ceil(boxes.length / 6 / ARITY));
  for (let at = 0; at < parents.length; at += 6) {
    const children = boxes.subarray(ARITY * at, ARITY * (at + 6));
    for (let axis = 0; axis < 3; axis++) {
      let min = children[axis];
      let max = children[3 + axis];
      for (let child = 6; child < children.length; child += 6) {
        min = Math.min(min, children[child + axis]);
        max = Math.max(max, children[child + 3 + axis]);
      }
      parents[at + axis] = min;
      parents[at + 3 + axis] = max;
    }
  }
  return parents;
}

/** One ray's way through the tree, front to back. */
class Walk {
  readonly #blobs: RayBlobs;
  readonly #levels: readonly Float32Array[];
  readonly #options: RayOptions;
  readonly #near: number;
  readonly #far: number;
  /** Origin, direction of length 1, and two directions across it. */
  readonly #ray: Float64Array;
  /** Nodes to visit: a heap by the distance at which the ray enters them. */
  readonly #entries: number[] = [];
  readonly #nodes: number[] = [];
  /** Blobs that are met, by distance; those before `#passed` have been blended. */
  readonly #distances: number[] = [];
  readonly #alphas: number[] = [];
  #passed = 0;
  #transmittance = 1;
  /** Share of what is seen of the blob that contributes most, and its distance. */
  #heaviest = 0;
  #heaviestAt = 0;

  /** @param ray origin, and direction of length 1. */
  constructor(
    blobs: RayBlobs,
    levels: readonly Float32Array[],
    ray: readonly number[],
    options: RayOptions,
    [near, far]: readonly [near: number, far: number],
  ) {
    this.#blobs = blobs;
    this.#levels = levels;
    this.#ray = Float64Array.from([...ray, ...across(ray[3], ray[4], ray[5])]);
    this.#options = options;
    this.#near = near;
    this.#far = far;
  }

  /** Returns the distance of the blob that contributes most; null if all together have less opacity. */
  run(minOpacity: number): number | null {
    const top = this.#levels.length - 1;
    this.#enter(top, 0, this.#levels[top].length / 6);
    while (this.#entries.length > 0) {
      this.#blend(this.#entries[0]);
      if (this.#isDecided(minOpacity)) break;
      const node = this.#pop();
      const level = node % 32;
      const index = Math.floor(node / 32);
      if (level === 0) this.#meetBlobs(index);
      else this.#enter(level - 1, ARITY * index, ARITY * (index + 1));
    }
    if (!this.#isDecided(minOpacity)) this.#blend(Number.POSITIVE_INFINITY);
    return 1 - this.#transmittance >= minOpacity ? this.#heaviestAt : null;
  }

  /** Whether nothing behind what has been blended can contribute more than the heaviest there. */
  #isDecided(minOpacity: number): boolean {
    return this.#heaviest >= this.#transmittance && 1 - this.#transmittance >= minOpacity;
  }

  /** Blends what is nearer than `distance`. */
  #blend(distance: number): void {
    while (this.#passed < this.#distances.length && this.#distances[this.#passed] <= distance) {
      const weight = this.#transmittance * this.#alphas[this.#passed];
      this.#transmittance -= weight;
      if (weight > this.#heaviest) {
        this.#heaviest = weight;
        this.#heaviestAt = this.#distances[this.#passed];
      }
      this.#passed++;
    }
  }

  #enter(level: number, from: number, end: number): void {
    const boxes = this.#levels[level];
    const count = boxes.length / 6;
    // By index: taking arrays apart by pattern takes as long as a box does.
    const ray = this.#ray;
    const ox = ray[0];
    const oy = ray[1];
    const oz = ray[2];
    const perX = 1 / ray[3];
    const perY = 1 / ray[4];
    const perZ = 1 / ray[5];
    const near = this.#near;
    const far = this.#far;
    for (let index = from; index < end && index < count; index++) {
      const at = 6 * index;
      const x0 = boxes[at] - ox;
      const y0 = boxes[at + 1] - oy;
      const z0 = boxes[at + 2] - oz;
      const x1 = boxes[at + 3] - ox;
      const y1 = boxes[at + 4] - oy;
      const z1 = boxes[at + 5] - oz;
      const slack = BOX_SLACK * Math.max(-x0, x1, -y0, y1, -z0, z1, 0);
      let enter = near;
      let leave = far;
      // Along an axis the ray is at rest on: ±Infinity, or NaN on a face, which no comparison takes.
      const ax = (x0 - slack) * perX;
      const bx = (x1 + slack) * perX;
      const ay = (y0 - slack) * perY;
      const by = (y1 + slack) * perY;
      const az = (z0 - slack) * perZ;
      const bz = (z1 + slack) * perZ;
      if (ax < bx) {
        if (ax > enter) enter = ax;
        if (bx < leave) leave = bx;
      } else {
        if (bx > enter) enter = bx;
        if (ax < leave) leave = ax;
      }
      if (ay < by) {
        if (ay > enter) enter = ay;
        if (by < leave) leave = by;
      } else {
        if (by > enter) enter = by;
        if (ay < leave) leave = ay;
      }
      if (az < bz) {
        if (az > enter) enter = az;
        if (bz < leave) leave = bz;
      } else {
        if (bz > enter) enter = bz;
        if (az < leave) leave = az;
      }
      if (enter <= leave) this.#push(enter, 32 * index + level);
    }
  }

  #meetBlobs(node: number): void {
    const { values, boxes, count } = this.#blobs;
    const ray = this.#ray;
    const ox = ray[0];
    const oy = ray[1];
    const oz = ray[2];
    const dx = ray[3];
    const dy = ray[4];
    const dz = ray[5];
    const ux = ray[6];
    const uy = ray[7];
    const uz = ray[8];
    const vx = ray[9];
    const vy = ray[10];
    const vz = ray[11];
    const near = this.#near;
    const far = this.#far;
    const { opacity: factor = 1, shownAt } = this.#options;
    const box = 6 * node;
    const stepX = (boxes[box + 3] - boxes[box]) / MEAN_STEPS;
    const stepY = (boxes[box + 4] - boxes[box + 1]) / MEAN_STEPS;
    const stepZ = (boxes[box + 5] - boxes[box + 2]) / MEAN_STEPS;
    const end = Math.min(count, ARITY * (node + 1));
    for (let blob = ARITY * node; blob < end; blob++) {
      const at = BLOB_VALUES * blob;
      const x = boxes[box] + stepX * values[at] - ox;
      const y = boxes[box + 1] + stepY * values[at + 1] - oy;
      const z = boxes[box + 2] + stepZ * values[at + 2] - oz;
      const depth = x * dx + y * dy + z * dz;
      if (!(depth > near && depth > 0 && depth <= far)) continue;
      const sx = DEVIATIONS[values[at + 3]];
      const sy = DEVIATIONS[values[at + 4]];
      const sz = DEVIATIONS[values[at + 5]];
      const dilation = DILATION * depth * depth;
      // Most of a node's blobs are far off the ray.
      const offset = x * x + y * y + z * z - depth * depth;
      if (offset > MOST_SQUARED * (sx * sx + sy * sy + sz * sz + dilation)) continue;
      const xy = sx * sy * correlationOf(values[at + 6]);
      const xz = sx * sz * correlationOf(values[at + 7]);
      const yz = sy * sz * correlationOf(values[at + 8]);
      // Covariance times each direction across.
      const cux = sx * sx * ux + xy * uy + xz * uz;
      const cuy = xy * ux + sy * sy * uy + yz * uz;
      const cuz = xz * ux + yz * uy + sz * sz * uz;
      const cvx = sx * sx * vx + xy * vy + xz * vz;
      const cvy = xy * vx + sy * sy * vy + yz * vz;
      const cvz = xz * vx + yz * vy + sz * sz * vz;
      const uu = ux * cux + uy * cuy + uz * cuz + dilation;
      const vv = vx * cvx + vy * cvy + vz * cvz + dilation;
      const uv = ux * cvx + uy * cvy + uz * cvz;
      const determinant = Math.max(uu * vv - uv * uv, 1e-12 * uu * vv);
      // From the blob's middle to the ray.
      const a = -(x * ux + y * uy + z * uz);
      const b = -(x * vx + y * vy + z * vz);
      const wa = (vv * a - uv * b) / determinant;
      const wb = (uu * b - uv * a) / determinant;
      const squared = a * wa + b * wb;
      if (squared > MOST_SQUARED) continue;
      const opacity = (values[at + 9] / 65535) * MOST_OPACITY;
      const alpha = factor * opacity * Math.exp(-0.5 * squared);
      if (alpha < LEAST_ALPHA) continue;
      // Whether the ray begins inside: how far from the blob's middle along the ray, for a point on it.
      const du = dx * cux + dy * cuy + dz * cuz;
      const dv = dx * cvx + dy * cvy + dz * cvz;
      const along = depth + du * wa + dv * wb;
      const dd =
        dx * (sx * sx * dx + xy * dy + xz * dz) +
        dy * (xy * dx + sy * sy * dy + yz * dz) +
        dz * (xz * dx + yz * dy + sz * sz * dz);
      const spread = dd - (du * (vv * du - uv * dv) + dv * (uu * dv - uv * du)) / determinant;
      if (along * along < (INSIDE_DEVIATIONS * INSIDE_DEVIATIONS - squared) * spread) continue;
      const shown = shownAt ? shownAt(ox + depth * dx, oy + depth * dy, oz + depth * dz) : 1;
      const seen = Math.min(MOST_ALPHA, alpha * shown);
      if (seen >= LEAST_ALPHA) this.#meet(depth, seen);
    }
  }

  #meet(distance: number, alpha: number): void {
    const distances = this.#distances;
    const alphas = this.#alphas;
    let at = distances.length;
    distances.push(distance);
    alphas.push(alpha);
    for (; at > this.#passed && distances[at - 1] > distance; at--) {
      distances[at] = distances[at - 1];
      alphas[at] = alphas[at - 1];
    }
    distances[at] = distance;
    alphas[at] = alpha;
  }

  #push(entry: number, node: number): void {
    const entries = this.#entries;
    const nodes = this.#nodes;
    let at = entries.length;
    entries.push(entry);
    nodes.push(node);
    while (at > 0) {
      const parent = (at - 1) >> 1;
      if (entries[parent] <= entry) break;
      entries[at] = entries[parent];
      nodes[at] = nodes[parent];
      at = parent;
    }
    entries[at] = entry;
    nodes[at] = node;
  }

  #pop(): number {
    const entries = this.#entries;
    const nodes = this.#nodes;
    const result = nodes[0];
    const entry = entries.pop()!;
    const node = nodes.pop()!;
    const count = entries.length;
    if (count === 0) return result;
    let at = 0;
    for (let child = 1; child < count; child = 2 * at + 1) {
      if (child + 1 < count && entries[child + 1] < entries[child]) child++;
      if (entries[child] >= entry) break;
      entries[at] = entries[child];
      nodes[at] = nodes[child];
      at = child;
    }
    entries[at] = entry;
    nodes[at] = node;
    return result;
  }
}

/** Powers of two are looked up: a ray needs hundreds of them. */
const DEVIATIONS = Float64Array.from(
  { length: 65536 },
  (_, i) => 2 ** ((i - DEVIATION_ZERO) / DEVIATION_STEPS),
);

function correlationOf(value: number): number {
  return (value - CORRELATION_ZERO) / CORRELATION_STEPS;
}

/** Two directions that are perpendicular to x, y, z and to each other. */
function across(x: number, y: number, z: number): number[] {
  // Duff et al. 2017, Building an Orthonormal Basis, Revisited.
  const sign = z < 0 ? -1 : 1;
  const a = -1 / (sign + z);
  const b = x * y * a;
  return [1 + sign * x * x * a, sign * b, -sign * x, b, sign + y * y * a, -y];
}
