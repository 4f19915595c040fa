import type { FrustumSide } from '../../data/camera/frustum.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { cross, dot, plus, scaled, unit } from '../../data/math/vec3.ts';
import type { CloudSight } from './cloud-sight.ts';

/** Prediction horizon, ms. */
const AHEAD_MS = 350;
/** Period over which motion is measured, ms, because the times of single frames vary. */
const MEASURED_MS = 200;
/** Least sine of the angle between two planes whose normals tell how a frustum has turned. */
const LEAST_SINE = 1e-3;

interface Sighting {
  readonly sights: readonly CloudSight[];
  readonly atMs: number;
}

/** Extrapolates the sights of a moving view from its last frames. */
export class SightPrediction {
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

/** @param factor multiplies the motion from `from` to `to`, which then goes on from `to`. */
function extrapolate(from: CloudSight, to: CloudSight, factor: number): CloudSight {
  const turn = turnBetween(from.sides, to.sides);
  const camera = turn
    ? onwardAround(from.cut.camera, to.cut.camera, factor, turn)
    : plus(to.cut.camera, plus(to.cut.camera, from.cut.camera, -1), factor);
  const sides = to.sides.map((side, i) => {
    const before = from.sides[i] ?? side;
    const normal = turn ? turnedBy(side.normal, turn, factor * turn.angle) : side.normal;
    // Frustum planes move with the camera.
    const [apartBefore, apart] = [apartFrom(from.cut.camera, before), apartFrom(to.cut.camera, side)];
    return { ...side, normal, offset: apart + factor * (apart - apartBefore) - dot(normal, camera) };
  });
  return { ...to, cut: { ...to.cut, camera }, sides };
}

interface Turn {
  /** A unit vector. */
  readonly axis: Vec3;
  /** Radians, 0…π. */
  readonly angle: number;
}

/** How a frustum has turned; null if it has not, or if all of its planes are parallel. */
function turnBetween(from: readonly FrustumSide[], to: readonly FrustumSide[]): Turn | null {
  const second = to.findIndex(({ normal }) => Math.hypot(...cross(to[0].normal, normal)) > LEAST_SINE);
  if (second < 0 || !from[second]) return null;
  const [before, after] = [from, to].map((sides) => axesOf(sides[0].normal, sides[second].normal));
  // Rows of the rotation matrix from the axes before to the axes after.
  const rows = [0, 1, 2].map((row) =>
    [0, 1, 2].map((column) => before.reduce((sum, axis, i) => sum + after[i][row] * axis[column], 0)),
  );
  const sine2: Vec3 = [rows[2][1] - rows[1][2], rows[0][2] - rows[2][0], rows[1][0] - rows[0][1]];
  const length = Math.hypot(...sine2);
  if (length === 0) return null;
  const angle = Math.atan2(length, rows[0][0] + rows[1][1] + rows[2][2] - 1);
  return { axis: [sine2[0] / length, sine2[1] / length, sine2[2] / length], angle };
}

/** Three orthogonal unit vectors, of which the first is along `a`, and the second in the plane of both. */
function axesOf(a: Vec3, b: Vec3): readonly Vec3[] {
  const first = unit(a);
  const third = unit(cross(a, b));
  return [first, cross(third, first), third];
}

/** Rodrigues' formula. */
function turnedBy(vector: Vec3, { axis }: Turn, angle: number): Vec3 {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  const turned = plus(scaled(vector, cosine), cross(axis, vector), sine);
  return plus(turned, axis, (1 - cosine) * dot(axis, vector));
}

/**
 * A camera that turns also moves along an arc, as in an orbit or around a corner. The chord of the arc
 * to come is the chord of the arc so far, turned by half of both angles.
 */
function onwardAround(from: Vec3, to: Vec3, factor: number, turn: Turn): Vec3 {
  const { axis, angle } = turn;
  const chord = plus(to, from, -1);
  const along = dot(chord, axis);
  const turned = turnedBy(plus(chord, axis, -along), turn, ((1 + factor) * angle) / 2);
  const stretch = Math.sin((factor * angle) / 2) / Math.sin(angle / 2);
  return plus(plus(to, turned, stretch), axis, factor * along);
}

function apartFrom(point: Vec3, { normal, offset }: FrustumSide): number {
  return dot(normal, point) + offset;
}
