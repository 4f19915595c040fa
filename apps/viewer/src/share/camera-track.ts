import { hermite } from '../state/hermite.ts';
import type { Vec3 } from '../state/vec3.ts';
import { clamp } from '../state/vec3.ts';
import type { CameraTrack, SettingsPose } from './scene-settings.ts';

/** The camera of a track `elapsedS` after its beginning. It passes the keys exactly. */
export function poseOnTrack(track: CameraTrack, elapsedS: number): SettingsPose {
  const { keys, isStepped, smoothness } = closed(track);
  const timeS = timeOnTrack(track, elapsedS);
  const at = Math.max(
    0,
    keys.findLastIndex((key) => key.timeS <= timeS),
  );
  const from = keys[at];
  const to = keys[at + 1];
  if (!to || isStepped) return from.pose;
  const spanS = to.timeS - from.timeS;
  const part = clamp((timeS - from.timeS) / spanS, 0, 1);
  const slope = (index: number, of: (pose: SettingsPose) => number) => {
    const [before, after] = [keys[index - 1] ?? keys[index], keys[index + 1] ?? keys[index]];
    return (smoothness * spanS * (of(after.pose) - of(before.pose))) / (after.timeS - before.timeS);
  };
  const value = (of: (pose: SettingsPose) => number) =>
    hermite(of(from.pose), slope(at, of), of(to.pose), slope(at + 1, of), part);
  const vector = (name: 'position' | 'target'): Vec3 => [
    value((pose) => pose[name][0]),
    value((pose) => pose[name][1]),
    value((pose) => pose[name][2]),
  ];
  const fovDegrees = value((pose) => pose.fovDegrees);
  return {
    position: vector('position'),
    target: vector('target'),
    // Slopes of a huge smoothness cancel out to no number.
    fovDegrees: Number.isNaN(fovDegrees) ? from.pose.fovDegrees : clamp(fovDegrees, 1, 179),
  };
}

/** Whether a track that is played once has come to its end. */
export function isAtEnd({ loop, durationS }: CameraTrack, elapsedS: number): boolean {
  return loop === 'none' && elapsedS >= durationS;
}

/** A track that repeats goes from its last key on to the first. */
function closed(track: CameraTrack): CameraTrack {
  const { keys, loop, durationS } = track;
  const [first] = keys;
  if (loop !== 'repeat' || durationS <= keys[keys.length - 1].timeS) return track;
  return { ...track, keys: [...keys, { timeS: first.timeS + durationS, pose: first.pose }] };
}

function timeOnTrack({ loop, durationS }: CameraTrack, elapsedS: number): number {
  if (loop === 'none') return Math.min(elapsedS, durationS);
  if (loop === 'repeat') return elapsedS % durationS;
  const there = elapsedS % (2 * durationS);
  return there <= durationS ? there : 2 * durationS - there;
}
