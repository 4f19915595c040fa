import { flippedPoint } from '../camera/flip.ts';
import { type CameraPath, viewOnPath } from '../navigate/view-path.ts';
import type { Annotation } from '../state/annotating.ts';
import type { ViewedCamera } from '../state/saved-view.ts';
import type { Vec3 } from '../state/vec3.ts';
import type { CameraTrack, SceneSettings, SettingsPose } from './scene-settings.ts';
import { longerFov, settingsPoseOf, uprightPoint } from './settings-pose.ts';

/** SuperSplat counts frames in its times, and takes no more keys than this. */
export const SETTINGS_FRAMES_PER_S = 30;
const MOST_KEYS = 1000;
/** Fewest frames between keys: a tenth of a second, of which times between views are multiples. */
const LEAST_FRAMES = 3;

/** Facts of a scene that its `settings.json` depends on. */
export interface SettingsScene {
  /** Whether the file's y axis points down. */
  readonly isUpsideDown: boolean;
  /** Width by height of the picture. */
  readonly aspect: number;
  /** sRGB, 0…1. */
  readonly background: Vec3;
}

/**
 * The settings that show a view of the scene, and then the path if there is one; and the
 * annotations.
 */
export function settingsOfView(
  view: ViewedCamera,
  path: CameraPath | null,
  annotations: readonly Annotation[],
  scene: SettingsScene,
): SceneSettings {
  return {
    camera: poseIn(scene, view),
    background: scene.background,
    track: path && trackOf(path, scene),
    annotations: annotations.map(({ point, title, text, view: shown }) => ({
      position: uprightPoint(scene.isUpsideDown ? flippedPoint(point) : point),
      title,
      text,
      camera: poseIn(scene, shown),
    })),
  };
}

/**
 * Between keys, SuperSplat's viewer moves the camera in straight lines that it rounds, and this one
 * around the target: so many keys lie within 0.1 % of each other.
 */
function trackOf(path: CameraPath, scene: SettingsScene): CameraTrack {
  const framesAt = (ms: number) => Math.round((ms * SETTINGS_FRAMES_PER_S) / 1000);
  const endFrame = framesAt(path.durationMs);
  const stepFrames = LEAST_FRAMES * Math.ceil(endFrame / (LEAST_FRAMES * (MOST_KEYS - 2 * path.keys.length)));
  const frames = new Set(path.keys.map(({ atMs }) => framesAt(atMs)));
  // A view that is held stays until the frame before the next one.
  for (const [i, { passing }] of path.keys.entries())
    if (passing === 'cut') frames.add(framesAt(path.keys[i + 1]?.atMs ?? path.durationMs) - 1);
  for (let frame = 0; frame < endFrame; frame += stepFrames) frames.add(frame);
  // A loop goes on from its last key to the first.
  if (!path.isLooped) frames.add(endFrame);
  const keys = [...frames]
    .sort((a, b) => a - b)
    .map((frame) => {
      const timeS = frame / SETTINGS_FRAMES_PER_S;
      return { timeS, pose: poseIn(scene, viewOnPath(path, 1000 * timeS)) };
    });
  return {
    durationS: path.durationMs / 1000,
    loop: path.isLooped ? 'repeat' : 'none',
    isStepped: false,
    smoothness: 1,
    keys,
  };
}

function poseIn({ isUpsideDown, aspect }: SettingsScene, view: ViewedCamera): SettingsPose {
  const { pose, fovDegrees, isFlipped } = view;
  const upright = settingsPoseOf(pose, longerFov(fovDegrees, aspect));
  if (isFlipped === isUpsideDown) return upright;
  // Settings are about the scene the way up that it comes with.
  return { ...upright, position: flippedPoint(upright.position), target: flippedPoint(upright.target) };
}
