import { DILATION_PX2 } from '../../data/accuracy/accuracy.ts';
import { type Camera, perspectiveCamera, projectionOf } from '../../data/camera/camera.ts';
import { checkKind, given, type Members } from '../../data/given.ts';
import { identity4, linearPart, multiply4, type Vec3 } from '../../data/math/mat4.ts';
import { LEAST_OPACITY } from '../splat-shape.ts';
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

/** The intersection of a ray with a cloud. */
export interface RayHit {
  /** In units of the direction's length. */
  readonly distance: number;
  readonly point: Vec3;
}

/** The camera and image that a ray belongs to. */
export interface RayView {
  readonly camera: Camera;
  /** From the cloud's space to the world, 16 numbers, column-major. Default: identity. */
  readonly modelMatrix?: ArrayLike<number>;
  /** Height of the image, px. Default: 1,000. Drawing widens each splat by about half a pixel. */
  readonly heightPx?: number;
}

/** The image that a ray belongs to, and its range. */
export interface RayOptions {
  /**
   * The view of the ray: splats are hit as they are drawn there, like in `pick`. Rays of a
   * perspective camera start at the camera; rays of an orthographic camera have its direction.
   * Default: a camera that looks along the ray, with a field of view of 50 degrees.
   */
  readonly view?: RayView;
  /** Splats nearer than this are skipped, in units of the direction's length. Default: 0. */
  readonly near?: number;
  /** Range, in units of the direction's length. Default: Infinity. */
  readonly far?: number;
  /** Least opacity, 0…1, of all splats on the ray together for a hit. Default: 0.3. */
  readonly minOpacity?: number;
  /** Multiplies every splat's opacity, 0…1. Default: 1. */
  readonly opacity?: number;
  /**
   * Returns a factor of opacity, 0…1, for splats at a position in the cloud's space; 0 if they are
   * cut off. Default: 1.
   */
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
/** Opacity of a splat is clamped to this, as in drawing. */
const MOST_ALPHA = 0.99;
/** Smaller contributions are left out, as in drawing. */
const LEAST_ALPHA = LEAST_OPACITY;
/**
 * Squared distance, in standard deviations, beyond which even the most opaque blob contributes less
 * than LEAST_ALPHA.
 */
const MOST_SQUARED = 2 * Math.log(MOST_OPACITY / LEAST_ALPHA);
/** Blobs are left out if the ray begins within this many standard deviations of their centre. */
const INSIDE_DEVIATIONS = 2;
/**
 * Boxes are enlarged by this many standard deviations of the dilation that drawing adds to each
 * splat.
 */
const DILATION_DEVIATIONS = 3;
const USUAL_HEIGHT_PX = 1000;
const USUAL_FOV_DEGREES = 50;

/**
 * A tree of bounding boxes around a cloud's splats, to cast rays at. Above half a million splats,
 * neighbouring splats are merged into blobs. Takes 24 bytes per splat or blob.
 */
export class RayTree {
  /** @internal */
  readonly origin: Vec3;
  /** Bytes of memory. */
  readonly bytes: number;
  readonly #blobs: RayBlobs;
  /** Boxes by level, the boxes around blobs first. */
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
   * Casts a ray in the cloud's own space. The hit is at the depth of the splat that contributes
   * most along the ray, like in `pick`. Splats around the ray's origin are left out. Synchronous.
   *
   * @param direction a vector of any length but 0.
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
  /** Nodes to visit: a heap, ordered by the distance at which the ray enters them. */
  readonly #entries: number[] = [];
  readonly #nodes: number[] = [];
  /** Blobs hit so far, sorted by distance; blobs before `#passed` have been blended. */
  readonly #distances: number[] = [];
  readonly #alphas: number[] = [];
  #passed = 0;
  #transmittance = 1;
  /** Largest contribution of a blob so far, and its distance. */
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

  /**
   * Returns the distance of the blob that contributes most; null if all blobs together have less
   * opacity.
   */
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
      // If the ray is parallel to an axis: ±Infinity, or NaN on a face, which fails all
      // comparisons.
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
      // Splats are drawn in the order of their centres' depths. Some centres in a box may be nearer
      // than the point at which the ray enters it.
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
      // From the blob's centre to the ray, on the plane at depth 1.
      const a = tangentX - middleX;
      const b = tangentY - middleY;
      // Rows of the Jacobian from positions in the cloud to positions on that plane.
      const shearX = isOrthographic ? 0 : Math.max(minX, Math.min(maxX, middleX)) * perDepth;
      const shearY = isOrthographic ? 0 : Math.max(minY, Math.min(maxY, middleY)) * perDepth;
      const jxx = (rx - shearX * fx) * perZ;
      const jxy = (ry - shearX * fy) * perZ;
      const jxz = (rz - shearX * fz) * perZ;
      const jyx = (ux - shearY * fx) * perZ;
      const jyy = (uy - shearY * fy) * perZ;
      const jyz = (uz - shearY * fz) * perZ;
      // Most blobs of a node are far off the ray.
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
      // By Lagrange's identity a sum of squares: nothing cancels.
      const determinant = c0 * c0 + c1 * c1 + c2 * c2 + dilation * (xx + yy + dilation);
      const squared = ((yy + dilation) * a * a - 2 * xy * a * b + (xx + dilation) * b * b) / determinant;
      if (!(squared <= MOST_SQUARED)) continue;
      const opacity = (values[at + 9] / 65535) * MOST_OPACITY;
      const alpha = factor * opacity * Math.exp(-0.5 * squared);
      if (alpha < LEAST_ALPHA) continue;
      // Standard deviations from the blob's centre to the ray's origin.
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

/** Tables of powers of two and of cosines, because a ray needs hundreds of them. */
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

/** A ray and the view around it. Lengths are in the cloud's space, unless a unit is given. */
interface ScreenRay {
  readonly ox: number;
  readonly oy: number;
  readonly oz: number;
  readonly dx: number;
  readonly dy: number;
  readonly dz: number;
  /**
   * A position times this vector is its view depth, as a distance along the ray in units of the
   * direction.
   */
  readonly fx: number;
  readonly fy: number;
  readonly fz: number;
  /** View depth per unit of distance. */
  readonly perDepth: number;
  /** A position times these vectors is its x and y in view space. */
  readonly rx: number;
  readonly ry: number;
  readonly rz: number;
  readonly ux: number;
  readonly uy: number;
  readonly uz: number;
  /** Offset of the ray from its origin on the plane at depth 1; any plane if orthographic. */
  readonly tangentX: number;
  readonly tangentY: number;
  /** Limits to which positions on that plane are clamped for the Jacobian. */
  readonly minX: number;
  readonly maxX: number;
  readonly minY: number;
  readonly maxY: number;
  readonly isOrthographic: boolean;
  /** Variance that drawing adds on that plane. */
  readonly dilation: number;
  /** Enlargement of boxes per unit of depth; if orthographic, in total. */
  readonly boxSlack: number;
}

/** Returns null if the ray points backwards in the view. */
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
  // For orthographic views: the least scale from the cloud's space to view space.
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
