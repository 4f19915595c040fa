import { flippedPoint } from '../camera/flip.ts';
import { PATH_STEP_MS, pathMs, pathThrough, placeOnPath, poseOnPath } from '../navigate/view-path.ts';
import type { Annotation } from '../state/annotating.ts';
import type { SavedView, ViewedCamera } from '../state/saved-view.ts';
import type { Vec3 } from '../state/vec3.ts';
import type { CameraTrack, SceneSettings, SettingsPose } from './scene-settings.ts';
import { longerFov, settingsPoseOf, uprightPoint } from './settings-pose.ts';

/**
 * From one saved view to the next: between keys SuperSplat's viewer moves the camera in straight
 * lines that it rounds, this one around the target. So many lie within 0.1 % of each other, and the
 * 736 of the longest path are fewer than the 1000 that SuperSplat takes.
 */
const KEYS_PER_STEP = 15;

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
 * The settings that show a view of the scene, and then the path through saved views if there is one;
 * and the annotations.
 */
export function settingsOfView(
  view: ViewedCamera,
  savedViews: readonly SavedView[],
  annotations: readonly Annotation[],
  scene: SettingsScene,
): SceneSettings {
  const path = pathThrough(savedViews);
  return {
    camera: poseIn(scene, view),
    background: scene.background,
    track: path.length > 1 ? trackOf(path, scene) : null,
    annotations: annotations.map(({ point, title, text, view: shown }) => ({
      position: uprightPoint(scene.isUpsideDown ? flippedPoint(point) : point),
      title,
      text,
      camera: poseIn(scene, shown),
    })),
  };
}

function trackOf(path: readonly SavedView[], scene: SettingsScene): CameraTrack {
  const poses = path.map(({ pose }) => pose);
  const keys = Array.from({ length: KEYS_PER_STEP * (path.length - 1) + 1 }, (_, i) => {
    const elapsedMs = (i * PATH_STEP_MS) / KEYS_PER_STEP;
    const pose = poseOnPath(poses, placeOnPath(elapsedMs, path.length));
    return { timeS: elapsedMs / 1000, pose: poseIn(scene, { ...path[0], pose }) };
  });
  return { durationS: pathMs(path.length) / 1000, loop: 'none', isStepped: false, smoothness: 1, keys };
}

function poseIn({ isUpsideDown, aspect }: SettingsScene, view: ViewedCamera): SettingsPose {
  const { pose, fovDegrees, isFlipped } = view;
  const upright = settingsPoseOf(pose, longerFov(fovDegrees, aspect));
  if (isFlipped === isUpsideDown) return upright;
  // Settings are about the scene the way up that it comes with.
  return { ...upright, position: flippedPoint(upright.position), target: flippedPoint(upright.target) };
}
