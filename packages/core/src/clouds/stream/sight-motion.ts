import type { FrustumSide } from '../../data/camera/frustum.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import type { CloudSight } from './cloud-sight.ts';

/** Prediction horizon, ms. */
const AHEAD_MS = 500;
/** Period over which motion is measured, ms, because the times of single frames vary. */
const MEASURED_MS = 200;

interface Sighting {
  readonly sights: readonly CloudSight[];
  readonly atMs: number;
}

/** Extrapolates the sights of a moving view from its last frames. */
export class SightMotion {
  /** Oldest first; all but the first are younger than `MEASURED_MS`. */
  #past: readonly Sighting[] = [];

  take(sights: readonly CloudSight[], atMs: number): void {
    const past = [...this.#past, { sights, atMs }];
    const recent = past.findIndex((each) => each.atMs > atMs - MEASURED_MS);
    this.#past = past.slice(Math.max(0, recent - 1));
  }

  /** Call when the view has come to rest. */
  stop(): void {
    this.#past = this.#past.slice(-1);
  }

  /** Whether the view has moved within the last frames. */
  get isMoving(): boolean {
    const [from, to] = [this.#past[0], this.#past.at(-1)];
    if (!from || !to || from.sights.length !== to.sights.length) return false;
    return !to.sights.every((sight, i) => isSameView(from.sights[i], sight));
  }

  /** Sights extrapolated by `AHEAD_MS`; empty if the view does not move. */
  predict(): readonly CloudSight[] {
    const [from, to] = [this.#past[0], this.#past.at(-1)];
    if (!from || !to || from.atMs === to.atMs || from.sights.length !== to.sights.length) return [];
    const factor = AHEAD_MS / (to.atMs - from.atMs);
    return to.sights.flatMap((sight, i) =>
      isSameView(from.sights[i], sight) ? [] : [extrapolate(from.sights[i], sight, factor)],
    );
  }
}

/** Whether a view has not moved. */
export function isSameView(a: CloudSight, b: CloudSight): boolean {
  if (!isSamePoint(a.cut.camera, b.cut.camera) || a.sides.length !== b.sides.length) return false;
  return a.sides.every(({ normal, offset }, i) => {
    const other = b.sides[i];
    return offset === other.offset && isSamePoint(normal, other.normal);
  });
}

function isSamePoint(a: Vec3, b: Vec3): boolean {
  return a[0] === b[0] && a[1] === b[1] && a[2] === b[2];
}

/** @param factor multiplies the change from `from` to `to`, which is then added to `to`. */
function extrapolate(from: CloudSight, to: CloudSight, factor: number): CloudSight {
  const camera = onward(from.cut.camera, to.cut.camera, factor);
  const sides = to.sides.map((side, i) => {
    const before = from.sides[i] ?? side;
    const turned = onward(before.normal, side.normal, factor);
    const stretch = Math.hypot(...side.normal) / Math.max(Number.MIN_VALUE, Math.hypot(...turned));
    const normal = turned.map((value) => value * stretch) as [number, number, number];
    // Frustum planes move with the camera.
    const [apartBefore, apart] = [apartFrom(from.cut.camera, before), apartFrom(to.cut.camera, side)];
    return { ...side, normal, offset: apart + factor * (apart - apartBefore) - dot(normal, camera) };
  });
  return { ...to, cut: { ...to.cut, camera }, sides };
}

function onward(from: Vec3, to: Vec3, factor: number): [number, number, number] {
  const at = (axis: 0 | 1 | 2) => to[axis] + factor * (to[axis] - from[axis]);
  return [at(0), at(1), at(2)];
}

function apartFrom(point: Vec3, { normal, offset }: FrustumSide): number {
  return dot(normal, point) + offset;
}

function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
