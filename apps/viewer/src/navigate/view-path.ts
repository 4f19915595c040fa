import { flippedPoint } from '../camera/flip.ts';
import { axesOf, quaternionOf } from '../camera/rotation.ts';
import { hermite } from '../state/hermite.ts';
import { cameraAxes, lookAt, type OrbitPose, poseFromLookAt, unwound } from '../state/orbit-pose.ts';
import { type KeptView, type Passing, type Turntable, USUAL_STEP_MS } from '../state/saved-view.ts';
import type { ViewerState } from '../state/store.ts';
import { add, clamp, dot, scale } from '../state/vec3.ts';

/** A view that a path passes. */
export interface PathKey {
  readonly view: KeptView;
  /** From the path's beginning, ms. */
  readonly atMs: number;
  readonly toNextMs: number;
  readonly passing: Passing;
}

/** A movement of the camera through two or more views. */
export interface CameraPath {
  readonly keys: readonly PathKey[];
  /** With the way from the last view to the first if it is looped. */
  readonly durationMs: number;
  readonly isLooped: boolean;
}

/** Views of a turntable: between them, the shorter way round is unambiguous. */
const TURNTABLE_VIEWS = 4;

/** The turntable, or the path through the saved views; null if there are fewer than two. */
export function pathOf({
  savedViews,
  path: { isLooped, turntable },
}: Pick<ViewerState, 'savedViews' | 'path'>): CameraPath | null {
  if (turntable) return pathThrough(turntableViews(turntable), true);
  if (savedViews.length < 2) return null;
  return pathThrough(
    savedViews.map((view) => ({
      view,
      toNextMs: view.toNextMs ?? USUAL_STEP_MS,
      passing: view.passing ?? 'through',
    })),
    isLooped,
  );
}

/** Views a quarter of a turn apart. */
export function turntableViews({ view, durationMs }: Turntable): readonly Omit<PathKey, 'atMs'>[] {
  return Array.from({ length: TURNTABLE_VIEWS }, (_, i) => {
    const azimuth = view.pose.azimuth + (2 * Math.PI * i) / TURNTABLE_VIEWS;
    return {
      view: { ...view, pose: { ...view.pose, azimuth } },
      toNextMs: durationMs / TURNTABLE_VIEWS,
      passing: 'through',
    };
  });
}

/** The path through at least one view. */
export function pathThrough(views: readonly Omit<PathKey, 'atMs'>[], isLooped: boolean): CameraPath {
  let atMs = 0;
  const keys = views.map((each): PathKey => {
    const key = { ...each, atMs };
    atMs += each.toNextMs;
    return key;
  });
  return { keys, durationMs: isLooped ? atMs : keys[keys.length - 1].atMs, isLooped };
}

/** Index of the view that is passed last before a time on the path, which begins anew after its end. */
export function keyAt(path: CameraPath, elapsedMs: number): number {
  const timeMs = timeOnPath(path, elapsedMs);
  return Math.max(
    0,
    path.keys.findLastIndex(({ atMs }) => atMs <= timeMs),
  );
}

function timeOnPath({ durationMs, isLooped }: CameraPath, elapsedMs: number): number {
  if (!isLooped) return clamp(elapsedMs, 0, durationMs);
  return ((elapsedMs % durationMs) + durationMs) % durationMs;
}

/**
 * The camera `elapsedMs` after the path's beginning. The path sets out and comes to rest slowly
 * unless it is looped, and passes each view at its time. It is a cubic Hermite spline in time, whose
 * slope at a view is that between the views before and after.
 *
 * Views with one up are joined around their targets: the target, the logarithm of the distance, and
 * the angles by the shorter way round. Otherwise the camera's place and its turn are joined.
 */
export function viewOnPath(path: CameraPath, elapsedMs: number): KeptView {
  const at = keyAt(path, elapsedMs);
  const { view, passing } = path.keys[at];
  const nodes = nodesOf(path);
  const [before, from, to, after] = nodes.slice(at, at + 4);
  const { isFlipped, isZUp } = path.keys[0].view;
  const whole = { ...view, isFlipped, isZUp };
  const stepMs = to.atMs - from.atMs;
  if (passing === 'cut' || stepMs === 0) return { ...whole, ...poseAt(from.values, from) };
  const part = (timeOnPath(path, elapsedMs) - from.atMs) / stepMs;
  const place = hermite(0, from.isRest ? 0 : 1, 1, to.isRest ? 0 : 1, part);
  const slope = (a: PathNode, b: PathNode, i: number) =>
    a.atMs === b.atMs ? 0 : (stepMs * (b.values[i] - a.values[i])) / (b.atMs - a.atMs);
  const values = from.values.map((value, i) =>
    hermite(
      value,
      slope(before.passing === 'cut' ? from : before, to, i),
      to.values[i],
      slope(from, to.passing === 'cut' ? to : after, i),
      place,
    ),
  );
  return { ...whole, ...poseAt(values, from) };
}

/** A view of a path, or one beyond its ends, as numbers that are interpolated. */
interface PathNode extends Pick<PathKey, 'atMs' | 'passing'> {
  /** Whether the camera stands still there. */
  readonly isRest: boolean;
  readonly values: readonly number[];
  /** Null if the camera's turn is among the values. */
  readonly up: OrbitPose['up'] | null;
}

/** Cosine between directions that differ only by rounding. */
const SAME_UP_COSINE = 1 - 1e-9;

/**
 * The path's views, with the one before its first and the two after its last: of a loop those that
 * follow there, else the end itself.
 */
function nodesOf({ keys, durationMs, isLooped }: CameraPath): readonly PathNode[] {
  const last = keys.length - 1;
  const poses = keys.map(({ view }) => poseLike(keys[0].view, view));
  const { up } = poses[0];
  const isOneUp = poses.every((pose) => dot(pose.up, up) > SAME_UP_COSINE);
  const nodes: PathNode[] = [];
  // The first view keeps its angle, and others are unwound from there.
  const first = valuesOf(poses[0], keys[0].view.fovDegrees, isOneUp, undefined);
  for (let i = -1; i <= keys.length + 1; i++) {
    const turns = isLooped ? Math.floor(i / keys.length) : 0;
    const index = isLooped ? i - turns * keys.length : clamp(i, 0, last);
    const { view, atMs, passing } = keys[index];
    const follows = keys[isLooped ? (index + last) % keys.length : index - 1];
    const isEnd = !isLooped && (index === 0 || index === last);
    nodes.push({
      ...{ atMs: atMs + turns * durationMs, passing },
      isRest: isEnd || passing !== 'through' || follows?.passing === 'cut',
      values: valuesOf(poses[index], view.fovDegrees, isOneUp, nodes.at(-1)?.values ?? first),
      up: isOneUp ? up : null,
    });
  }
  return nodes;
}

/** The pose of `view` in the scene turned as `first` has it. */
function poseLike(first: KeptView, { pose, isFlipped }: KeptView): OrbitPose {
  if (isFlipped === first.isFlipped) return pose;
  const { position, target, up } = lookAt(pose);
  return poseFromLookAt({
    position: flippedPoint(position),
    target: flippedPoint(target),
    up: flippedPoint(up),
  });
}

/** @param near values of the view before, to which angles and turns are nearest. */
function valuesOf(
  pose: OrbitPose,
  fovDegrees: number,
  isOneUp: boolean,
  near: readonly number[] | undefined,
): readonly number[] {
  const away = Math.log(pose.distance);
  if (isOneUp) {
    const { azimuth } = unwound(pose, near?.[5] ?? pose.azimuth);
    return [fovDegrees, away, ...pose.target, azimuth, pose.polar];
  }
  const turn = quaternionOf(cameraAxes(pose));
  const nearness = near ? turn.reduce((sum, value, i) => sum + value * near[5 + i], 0) : 1;
  // Both signs are the same turn.
  return [
    fovDegrees,
    away,
    ...lookAt(pose).position,
    ...turn.map((value) => (nearness < 0 ? -value : value)),
  ];
}

/** Least angle to a pole, radians: at the pole itself, sideways is undefined. */
const MIN_POLAR = 0.01;

/** Between two views, a curve may swing past a pole, or past the fields of view that there are. */
function poseAt(
  [fovDegrees, away, x, y, z, a, b, c, d]: readonly number[],
  { up }: PathNode,
): Pick<KeptView, 'pose' | 'fovDegrees'> {
  const distance = Math.exp(away);
  const fov = clamp(fovDegrees, 1, 179);
  if (up) {
    const polar = clamp(b, MIN_POLAR, Math.PI - MIN_POLAR);
    return { pose: { target: [x, y, z], distance, azimuth: a, polar, up }, fovDegrees: fov };
  }
  const { above, back } = axesOf([a, b, c, d]);
  const target = add([x, y, z], scale(back, -distance));
  return { pose: poseFromLookAt({ position: [x, y, z], target, up: above }), fovDegrees: fov };
}
