import { DILATION_PX2 } from '../data/accuracy/accuracy.ts';
import { type Camera, perspectiveCamera, projectionOf } from '../data/camera/camera.ts';
import { checkKind, given, type Members } from '../data/given.ts';
import { identity4, linearPart, multiply4, type Vec3 } from '../data/math/mat4.ts';
import {
  ANGLE_STEPS,
  ARITY,
  BLOB_VALUES,
  DEVIATION_STEPS,
  DEVIATION_ZERO,
  MEAN_STEPS,
  type RayBlobs,
} from './arrange-blobs.ts';
import { MOST_OPACITY } from './ray-blobs.ts';
import { LEAST_OPACITY } from './splat-shape.ts';

/** Where a ray meets a cloud. */
export interface RayHit {
  /** In units of the direction's length. */
  readonly distance: number;
  readonly point: Vec3;
}

/** The image through one of whose pixels a ray goes. */
export interface RayView {
  readonly camera: Camera;
  /** From the cloud's space to the world, column-major; default none. */
  readonly modelMatrix?: ArrayLike<number>;
  /** Height of the image, px; default 1,000. Splats are drawn about half a pixel larger. */
  readonly heightPx?: number;
}

/** The image that a ray belongs to, and how far it goes. */
export interface RayOptions {
  /**
   * View of the ray: it meets splats as they are drawn there, as `pick` does. Rays of a perspective
   * camera begin where it stands, those of an orthographic one go where it looks. Default: a camera
   * that looks along the ray, with a field of view of 50 degrees.
   */
  readonly view?: RayView;
  /** Splats nearer than this are passed; in units of the direction's length, default 0. */
  readonly near?: number;
  /** Reach, in units of the direction's length; default Infinity. */
  readonly far?: number;
  /** Least opacity of the splats that a ray hits, 0…1; default 0.3. */
  readonly minOpacity?: number;
  /** Multiplies every splat's opacity, 0…1; default 1. */
  readonly opacity?: number;
  /** Returns the part of its opacity that a splat here has, 0…1; 0 if it is cut off. Default: 1. */
  readonly shownAt?: (x: number, y: number, z: number) => number;
}

const RAY: Members = {
  view: 'an object?',
  near: 'a number?',
  far: 'a number?',
  minOpacity: 'a number?',
  opacity: 'a number?',
  shownAt: 'a function?',
};

const DEFAULT_MIN_OPACITY = 0.3;
/** Opacity of a splat is limited to this when it is drawn. */
const MOST_ALPHA = 0.99;
/** Blobs contribute no less, as splats that are drawn. */
const LEAST_ALPHA = LEAST_OPACITY;
/** Squared standard deviations at which the most opaque blob contributes less. */
const MOST_SQUARED = 2 * Math.log(MOST_OPACITY / LEAST_ALPHA);
/** A ray that begins within so many standard deviations of a blob leaves that blob out. */
const INSIDE_DEVIATIONS = 2;
/** Boxes are met early by so many standard deviations of what drawing adds to each splat. */
const DILATION_DEVIATIONS = 3;
const USUAL_HEIGHT_PX = 1000;
const USUAL_FOV_DEGREES = 50;

/**
 * Targets of rays: a cloud's splats, or blobs of neighbouring splats if there are more than half a
 * million; and a tree of boxes around them. 24 bytes for each.
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
   * Returns where a ray in the cloud's own space meets splats: at the depth of those that
   * contribute most along it, as `pick` does. Splats that the ray begins inside of are left out.
   * Waits for nothing.
   *
   * @param direction vector of any length but 0.
   * @returns null if all splats on the ray together have less than `minOpacity`, or the ray is not
   *   finite.
   */
  cast(origin: Vec3, direction: Vec3, options: RayOptions = {}): RayHit | null {
    const {
      near = 0,
      far = Number.POSITIVE_INFINITY,
      minOpacity = DEFAULT_MIN_OPACITY,
    } = given(options, RAY);
    if (options.view) given(options.view.camera, {}, 'view.camera');
    checkKind('origin', origin, 'a list');
    checkKind('direction', direction, 'a list');
    const length = Math.hypot(...direction);
    if (!(length > 0 && length < Number.POSITIVE_INFINITY) || !origin.every(Number.isFinite)) return null;
    const from = origin.map((value, axis) => value - this.origin[axis]);
    const ray = screenRay(from, direction, options.view ?? { camera: cameraAlong(direction, length) });
    if (!ray) return null;
    const walk = new Walk(this.#blobs, this.#levels, ray, options, [near, far]);
    const distance = walk.run(Math.max(minOpacity, LEAST_ALPHA));
    if (distance === null) return null;
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
  readonly #ray: ScreenRay;
  /** Nodes to visit: a heap by the distance at which the ray enters them. */
  readonly #entries: number[] = [];
  readonly #nodes: number[] = [];
  /** Blobs that are met, by distance; those before `#passed` have been blended. */
  readonly #distances: number[] = [];
  readonly #alphas: number[] = [];
  #passed = 0;
  #transmittance = 1;
  /** Largest contribution of a blob, and the distance of that blob. */
  #heaviest = 0;
  #heaviestAt = 0;

  constructor(
    blobs: RayBlobs,
    levels: readonly Float32Array[],
    ray: ScreenRay,
    options: RayOptions,
    [near, far]: readonly [near: number, far: number],
  ) {
    this.#blobs = blobs;
    this.#levels = levels;
    this.#ray = ray;
    this.#options = options;
    this.#near = near;
    this.#far = far;
  }

  /** Returns the distance of the blob that contributes most; null if all have less opacity. */
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

  /** Whether no blob behind can contribute more than the heaviest so far. */
  #isDecided(minOpacity: number): boolean {
    return this.#heaviest >= this.#transmittance && 1 - this.#transmittance >= minOpacity;
  }

  /** Blends the blobs that are nearer than `distance`. */
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
    const { ox, oy, oz, dx, dy, dz, fx, fy, fz, boxSlack } = this.#ray;
    const perX = 1 / dx;
    const perY = 1 / dy;
    const perZ = 1 / dz;
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
      const slack = boxSlack * (this.#ray.isOrthographic ? 1 : Math.max(-x0, x1, -y0, y1, -z0, z1, 0));
      let enter = near;
      let leave = far;
      // Along an axis where the ray rests: ±Infinity, or NaN on a face, which fails comparisons.
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
      if (!(enter <= leave)) continue;
      // Splats are drawn in the order of their middles' depths, which those of a box may have
      // before the ray is in it.
      const nearest = fx * (fx > 0 ? x0 : x1) + fy * (fy > 0 ? y0 : y1) + fz * (fz > 0 ? z0 : z1);
      this.#push(Math.max(near, nearest), 32 * index + level);
    }
  }

  #meetBlobs(node: number): void {
    const { values, boxes, count } = this.#blobs;
    const { ox, oy, oz, dx, dy, dz, fx, fy, fz, rx, ry, rz, ux, uy, uz, perDepth, dilation } = this.#ray;
    const { tangentX, tangentY, minX, maxX, minY, maxY, isOrthographic } = this.#ray;
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
      const distance = x * fx + y * fy + z * fz;
      if (!(distance > near && distance > 0 && distance <= far)) continue;
      const sx = DEVIATIONS[values[at + 3]];
      const sy = DEVIATIONS[values[at + 4]];
      const sz = DEVIATIONS[values[at + 5]];
      const perZ = isOrthographic ? 1 : 1 / (distance * perDepth);
      const middleX = (x * rx + y * ry + z * rz) * perZ;
      const middleY = (x * ux + y * uy + z * uz) * perZ;
      // From the blob's middle to the ray, on a plane at depth 1.
      const a = tangentX - middleX;
      const b = tangentY - middleY;
      // Rows of the Jacobian of places on that plane by places in the cloud, in units of the plane.
      const shearX = isOrthographic ? 0 : Math.max(minX, Math.min(maxX, middleX)) * perDepth;
      const shearY = isOrthographic ? 0 : Math.max(minY, Math.min(maxY, middleY)) * perDepth;
      const jxx = (rx - shearX * fx) * perZ;
      const jxy = (ry - shearX * fy) * perZ;
      const jxz = (rz - shearX * fz) * perZ;
      const jyx = (ux - shearY * fx) * perZ;
      const jyy = (uy - shearY * fy) * perZ;
      const jyz = (uz - shearY * fz) * perZ;
      // Most of a node's blobs are far off the ray.
      const reachX = sx * Math.abs(jxx) + sy * Math.abs(jxy) + sz * Math.abs(jxz);
      if (a * a > MOST_SQUARED * (reachX * reachX + dilation)) continue;
      const reachY = sx * Math.abs(jyx) + sy * Math.abs(jyy) + sz * Math.abs(jyz);
      if (b * b > MOST_SQUARED * (reachY * reachY + dilation)) continue;
      const l10 = sy * cosineOf(values[at + 6]);
      const l11 = sy * sineOf(values[at + 6]);
      const across = sz * sineOf(values[at + 7]);
      const l20 = sz * cosineOf(values[at + 7]);
      const l21 = across * cosineOf(values[at + 8]);
      const l22 = across * sineOf(values[at + 8]);
      // J·L, whose rows span the ellipse.
      const x0 = jxx * sx + jxy * l10 + jxz * l20;
      const x1 = jxy * l11 + jxz * l21;
      const x2 = jxz * l22;
      const y0 = jyx * sx + jyy * l10 + jyz * l20;
      const y1 = jyy * l11 + jyz * l21;
      const y2 = jyz * l22;
      const xx = x0 * x0 + x1 * x1 + x2 * x2;
      const yy = y0 * y0 + y1 * y1 + y2 * y2;
      const xy = x0 * y0 + x1 * y1 + x2 * y2;
      const c0 = x1 * y2 - x2 * y1;
      const c1 = x2 * y0 - x0 * y2;
      const c2 = x0 * y1 - x1 * y0;
      // By Lagrange's identity a sum of squares, of which nothing cancels.
      const determinant = c0 * c0 + c1 * c1 + c2 * c2 + dilation * (xx + yy + dilation);
      const squared = ((yy + dilation) * a * a - 2 * xy * a * b + (xx + dilation) * b * b) / determinant;
      if (!(squared <= MOST_SQUARED)) continue;
      const opacity = (values[at + 9] / 65535) * MOST_OPACITY;
      const alpha = factor * opacity * Math.exp(-0.5 * squared);
      if (alpha < LEAST_ALPHA) continue;
      // Standard deviations between the blob's middle and where the ray begins.
      const e0 = x / sx;
      const e1 = (y - l10 * e0) / l11;
      const e2 = (z - l20 * e0 - l21 * e1) / l22;
      if (e0 * e0 + e1 * e1 + e2 * e2 < INSIDE_DEVIATIONS * INSIDE_DEVIATIONS) continue;
      const shown = shownAt ? shownAt(ox + distance * dx, oy + distance * dy, oz + distance * dz) : 1;
      const seen = Math.min(MOST_ALPHA, alpha * shown);
      if (seen >= LEAST_ALPHA) this.#meet(distance, seen);
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

/** Powers of two and cosines are looked up: a ray needs hundreds of them. */
const DEVIATIONS = Float64Array.from(
  { length: 65536 },
  (_, i) => 2 ** ((i - DEVIATION_ZERO) / DEVIATION_STEPS),
);

const COSINES = Float32Array.from({ length: ANGLE_STEPS + 1 }, (_, i) =>
  Math.cos((Math.PI * i) / ANGLE_STEPS),
);

function cosineOf(angle: number): number {
  return COSINES[angle];
}

function sineOf(angle: number): number {
  return COSINES[Math.abs(angle - ANGLE_STEPS / 2)];
}

/** A ray, and the view around it. Lengths are in the cloud's space but where a unit is given. */
interface ScreenRay {
  readonly ox: number;
  readonly oy: number;
  readonly oz: number;
  readonly dx: number;
  readonly dy: number;
  readonly dz: number;
  /**
   * Scalar product with it: distances in units of the direction, at which the ray is as deep in the
   * view.
   */
  readonly fx: number;
  readonly fy: number;
  readonly fz: number;
  /** View depth per unit of distance. */
  readonly perDepth: number;
  /** Scalar products with them: x and y in view space. */
  readonly rx: number;
  readonly ry: number;
  readonly rz: number;
  readonly ux: number;
  readonly uy: number;
  readonly uz: number;
  /** Where the ray is on a plane at depth 1 (orthographic: any), from where it begins. */
  readonly tangentX: number;
  readonly tangentY: number;
  /** Clamps of places on that plane, for the Jacobian. */
  readonly minX: number;
  readonly maxX: number;
  readonly minY: number;
  readonly maxY: number;
  readonly isOrthographic: boolean;
  /** Variance that is added on that plane. */
  readonly dilation: number;
  /** Distance outside of boxes at which rays meet them, per unit of depth (orthographic: all). */
  readonly boxSlack: number;
}

/** Returns null unless the ray goes forward in the view. */
function screenRay(
  [ox, oy, oz]: readonly number[],
  [dx, dy, dz]: Vec3,
  { camera, modelMatrix = identity4(), heightPx = USUAL_HEIGHT_PX }: RayView,
): ScreenRay | null {
  const { isOrthographic, focalPx, clampX, clampY } = projectionOf(camera, heightPx, heightPx);
  const v = linearPart(multiply4(camera.viewMatrix, modelMatrix));
  const perDepth = -(v[2] * dx + v[5] * dy + v[8] * dz);
  if (!(perDepth > 0)) return null;
  // Pixels are square.
  const dilation = DILATION_PX2 / focalPx[1] ** 2;
  // Of an orthographic image in the cloud's space: lengths are at least as long in view space.
  const leastScale = Math.max(Math.hypot(v[2], v[5], v[8]), 1e-30);
  return {
    ...{ ox, oy, oz, dx, dy, dz },
    ...{ fx: -v[2] / perDepth, fy: -v[5] / perDepth, fz: -v[8] / perDepth, perDepth },
    ...{ rx: v[0], ry: v[3], rz: v[6], ux: v[1], uy: v[4], uz: v[7] },
    tangentX: isOrthographic ? 0 : (v[0] * dx + v[3] * dy + v[6] * dz) / perDepth,
    tangentY: isOrthographic ? 0 : (v[1] * dx + v[4] * dy + v[7] * dz) / perDepth,
    ...{ minX: clampX[0], maxX: clampX[1], minY: clampY[0], maxY: clampY[1] },
    ...{ isOrthographic, dilation },
    boxSlack: (DILATION_DEVIATIONS * Math.sqrt(dilation)) / (isOrthographic ? leastScale : 1),
  };
}

function cameraAlong(direction: Vec3, length: number): Camera {
  const [x, y, z] = direction.map((value) => value / length);
  const least = Math.min(Math.abs(x), Math.abs(y), Math.abs(z));
  return perspectiveCamera({
    position: [0, 0, 0],
    target: [x, y, z],
    up: Math.abs(x) === least ? [1, 0, 0] : Math.abs(y) === least ? [0, 1, 0] : [0, 0, 1],
    fovYDegrees: USUAL_FOV_DEGREES,
    aspect: 1,
  });
}
