import { flippedPoint } from '../camera/flip.ts';
import { type CameraTrack, hasDirection, readCameraTrack } from '../share/scene-settings.ts';
import { poseOf, shorterFov } from '../share/settings-pose.ts';
import { FieldError } from '../state/json-fields.ts';
import { lookAt, poseFromLookAt } from '../state/orbit-pose.ts';
import { upVector } from '../state/up-axis.ts';
import { type FilePath, PathFileError, type PathScene } from './path-file.ts';

/** SuperSplat's smoothness below which its camera all but stops at each key. */
const STOPS_BELOW = 0.5;

/**
 * Reads the first movement of the camera in SuperSplat's `settings.json`, whether it begins by
 * itself or not.
 *
 * @throws PathFileError for another file, and for one without a movement.
 */
export function readSettingsPath(fileName: string, text: string, scene: PathScene): FilePath {
  const track = trackIn(fileName, text);
  if (!track) throw new PathFileError(fileName, 'its animTracks are empty.');
  const { keys, loop, isStepped, smoothness } = track;
  if (keys.some(({ pose }) => !hasDirection(pose)))
    throw new PathFileError(fileName, 'the target of a camera is where the camera is.');
  const passing = isStepped ? 'cut' : smoothness < STOPS_BELOW ? 'stop' : 'through';
  return {
    keys: keys.map(({ timeS, pose }) => ({
      atMs: 1000 * (timeS - keys[0].timeS),
      pose: drawn(poseOf(pose), scene),
      fovDegrees: shorterFov(pose.fovDegrees, scene.aspect),
      passing,
    })),
    durationMs: 1000 * (track.durationS - keys[0].timeS),
    isLooped: loop === 'repeat',
    notes: loop === 'pingpong' ? ['It is played to its end only, not back again.'] : [],
  };
}

/** The pose in the drawn scene, of one in the scene as it comes with y up. */
function drawn(
  pose: ReturnType<typeof poseOf>,
  { isFlipped, isZUp, isUpsideDown }: PathScene,
): ReturnType<typeof poseOf> {
  if (isFlipped === isUpsideDown && !isZUp) return pose;
  const { position, target } = lookAt(pose);
  const place = isFlipped === isUpsideDown ? (point: typeof target) => point : flippedPoint;
  return poseFromLookAt({ position: place(position), target: place(target), up: upVector({ isZUp }) });
}

function trackIn(fileName: string, text: string): CameraTrack | null {
  try {
    return readCameraTrack(text);
  } catch (error) {
    if (error instanceof FieldError) throw new PathFileError(fileName, error.message);
    throw error;
  }
}
