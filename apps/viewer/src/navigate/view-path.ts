import { hermite } from '../state/hermite.ts';
import { type OrbitPose, unwound } from '../state/orbit-pose.ts';
import type { SavedView } from '../state/saved-view.ts';
import { upAxisOf } from '../state/up-axis.ts';
import { clamp, dot } from '../state/vec3.ts';

/** Time from one view of a path to the next. */
export const PATH_STEP_MS = 2500;

/** How long the path through so many views takes, one or more. */
export function pathMs(views: number): number {
  return (views - 1) * PATH_STEP_MS;
}

/**
 * How far the path through so many views has come after a time: 0 at the first view, 1 at the
 * second. It sets out from the first view and comes to rest at the last one slowly; views are passed
 * every `PATH_STEP_MS`.
 */
export function placeOnPath(elapsedMs: number, views: number): number {
  const steps = views - 1;
  if (steps === 0) return 0;
  const at = clamp(elapsedMs / PATH_STEP_MS, 0, steps);
  const step = Math.min(Math.floor(at), steps - 1);
  return step + hermite(0, step === 0 ? 0 : 1, 1, step === steps - 1 ? 0 : 1, at - step);
}

/** Of directions that differ by rounding alone. */
const SAME_UP_COSINE = 1 - 1e-9;

/**
 * The views that a path passes: all of the first one's way up. It shows them all as the first does,
 * but for the pose.
 */
export function pathThrough(views: readonly SavedView[]): readonly SavedView[] {
  const [first] = views;
  const isSameUp = ({ pose }: SavedView) => dot(pose.up, first.pose.up) > SAME_UP_COSINE;
  return views.filter((view) => upAxisOf(view) === upAxisOf(first) && isSameUp(view));
}

/**
 * The pose at `at` of a smooth path through `poses` with the same up, which it passes at 0, 1, 2…;
 * before the first and after the last it stands still. A Catmull–Rom spline of the target, the
 * logarithm of the distance and the angles, each by the shorter way round.
 *
 * @throws RangeError if there are no poses.
 */
export function poseOnPath(poses: readonly OrbitPose[], at: number): OrbitPose {
  if (poses.length === 0) throw new RangeError('A path needs a view to pass.');
  const last = poses.length - 1;
  const from = clamp(Math.floor(at), 0, Math.max(0, last - 1));
  const part = clamp(at - from, 0, 1);
  const turned = withShortTurns(poses);
  const [a, b, c, d] = [from - 1, from, from + 1, from + 2].map((i) => turned[clamp(i, 0, last)]);
  const value = (of: (pose: OrbitPose) => number) => catmullRom(of(a), of(b), of(c), of(d), part);
  return {
    target: [
      value((pose) => pose.target[0]),
      value((pose) => pose.target[1]),
      value((pose) => pose.target[2]),
    ],
    distance: Math.exp(value((pose) => Math.log(pose.distance))),
    azimuth: value((pose) => pose.azimuth),
    // Between two views near a pole the curve may swing past it.
    polar: clamp(
      value((pose) => pose.polar),
      MIN_POLAR,
      Math.PI - MIN_POLAR,
    ),
    up: b.up,
  };
}

/** Radians from a pole at which there is a sideways direction. */
const MIN_POLAR = 0.01;

function withShortTurns(poses: readonly OrbitPose[]): readonly OrbitPose[] {
  const turned: OrbitPose[] = [];
  for (const pose of poses) turned.push(unwound(pose, turned.at(-1)?.azimuth ?? pose.azimuth));
  return turned;
}

function catmullRom(a: number, b: number, c: number, d: number, part: number): number {
  return hermite(b, (c - a) / 2, c, (d - b) / 2, part);
}
