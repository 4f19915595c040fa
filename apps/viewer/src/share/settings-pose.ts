import { flippedPoint } from '../camera/flip.ts';
import type { Background } from '../state/camera.ts';
import { lookAt, type OrbitPose, poseFromLookAt } from '../state/orbit-pose.ts';
import { Y_UP } from '../state/up-axis.ts';
import type { Vec3 } from '../state/vec3.ts';
import type { SettingsPose } from './scene-settings.ts';

/** SuperSplat's view of an upright file: SuperSplat turns files around z, this viewer around x. */
export function poseOf({ position, target }: SettingsPose): OrbitPose {
  return poseFromLookAt({ position: uprightPoint(position), target: uprightPoint(target), up: Y_UP });
}

/** The same of a pose, with a field of view over the image's longer side: undoes `poseOf`. */
export function settingsPoseOf(pose: OrbitPose, fovDegrees: number): SettingsPose {
  const { position, target } = lookAt(pose);
  return { position: uprightPoint(position), target: uprightPoint(target), fovDegrees };
}

/** SuperSplat's place of a point in an upright file's scene, and back. */
export function uprightPoint([x, y, z]: Vec3): Vec3 {
  // To the file's own coordinates, and from there.
  return flippedPoint([-x, -y, z]);
}

/** SuperSplat's field of view lies over the image's longer side, this viewer's over the shorter. */
export function shorterFov(fovDegrees: number, aspect: number): number {
  const half = Math.tan((fovDegrees * Math.PI) / 360) / Math.max(aspect, 1 / aspect);
  return (Math.atan(half) * 360) / Math.PI;
}

/** Undoes `shorterFov`. */
export function longerFov(fovDegrees: number, aspect: number): number {
  const half = Math.tan((fovDegrees * Math.PI) / 360) * Math.max(aspect, 1 / aspect);
  return (Math.atan(half) * 360) / Math.PI;
}

export function backgroundOf(color: Vec3): Background {
  const hex = color.map((value) =>
    Math.round(255 * Math.min(1, Math.max(0, value)))
      .toString(16)
      .padStart(2, '0'),
  );
  return `#${hex.join('')}`;
}
