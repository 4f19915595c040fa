import { hermite } from '../state/hermite.ts';
import { type OrbitPose, unwound } from '../state/orbit-pose.ts';
import type { SavedView } from '../state/saved-view.ts';
import { upAxisOf } from '../state/up-axis.ts';
import { clamp, dot } from '../state/vec3.ts';

/** Time from one view of a path to the next, ms. */
export const PATH_STEP_MS = 2500;

/** Duration of a path through `views` views, ms; at least one view. */
export function pathMs(views: number): number {
  return (views - 1) * PATH_STEP_MS;
}

/**
 * Position on a path after `elapsedMs`: 0 is the first view, 1 the second. The path starts and ends
 * slowly and passes a view every `PATH_STEP_MS`.
 */
export function placeOnPath(elapsedMs: number, views: number): number {
  const steps = views - 1;
  if (steps === 0) return 0;
  const at = clamp(elapsedMs / PATH_STEP_MS, 0, steps);
  const step = Math.min(Math.floor(at), steps - 1);
  return step + hermite(0, step === 0 ? 0 : 1, 1, step === steps - 1 ? 0 : 1, at - step);
}

/** Cosine between directions that differ only by rounding. */
const SAME_UP_COSINE = 1 - 1e-9;

/**
 * The views on a path: all views with the first one's way up. All are drawn with the first one's
 * settings; only the pose differs.
 */
export function pathThrough(views: readonly SavedView[]): readonly SavedView[] {
  const [first] = views;
  const isSameUp = ({ pose }: SavedView) => dot(pose.up, first.pose.up) > SAME_UP_COSINE;
  return views.filter((view) => upAxisOf(view) === upAxisOf(first) && isSameUp(view));
}

/**
 * The pose at position `at` of a smooth path through `poses`, which passes pose i at i and stands
 * still beyond its ends. All poses have the same up. The path is a Catmull–Rom spline of the
 * target, the logarithm of the distance, and the angles by the shorter way round.
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
    // Between two views near a pole, the curve may swing past the pole.
    polar: clamp(
      value((pose) => pose.polar),
      MIN_POLAR,
      Math.PI - MIN_POLAR,
    ),
    up: b.up,
  };
}

/** Least angle to a pole, radians: at the pole itself, sideways is undefined. */
const MIN_POLAR = 0.01;

function withShortTurns(poses: readonly OrbitPose[]): readonly OrbitPose[] {
  const turned: OrbitPose[] = [];
  for (const pose of poses) turned.push(unwound(pose, turned.at(-1)?.azimuth ?? pose.azimuth));
  return turned;
}

function catmullRom(a: number, b: number, c: number, d: number, part: number): number {
  return hermite(b, (c - a) / 2, c, (d - b) / 2, part);
}
