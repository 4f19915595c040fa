import { type Camera, type CloudInstance, perspectiveCamera, type Vec3 } from '@websplatter/core';
import { orbitCameras } from '@websplatter/core/measure';
import { depthRange, firstPose, verticalFov } from '../camera/framing.ts';
import { lookAt } from '../camera/orbit-pose.ts';
import { boundingSphere, boundsOf } from '../camera/scene-bounds.ts';
import { upVector } from '../camera/up-axis.ts';
import type { LoadedScene } from '../scene/load-scene.ts';
import { FIRST_LOOK } from '../state/look.ts';
import type { BenchRequest } from './bench-request.ts';

/** What a path is made for. */
export type BenchPathScene = Pick<
  LoadedScene,
  'clouds' | 'firstView' | 'ownCameras' | 'isUpsideDown' | 'isZUp'
>;

/**
 * The cameras of the measured frames: around the scene as the viewer shows it first, in an image of the benchmark's size. They
 * follow from scene and request alone.
 */
export function benchCameras(scene: BenchPathScene, request: Omit<BenchRequest, 'accuracy'>): Camera[] {
  const { frames, sweepDegrees, widthPx, heightPx } = request;
  const bounds = boundsOf(scene.clouds, 'robustBounds');
  return orbitCameras(firstCamera(scene, widthPx / heightPx), bounds, { count: frames, sweepDegrees });
}

function firstCamera(
  { clouds, firstView, ownCameras, ...uprightness }: BenchPathScene,
  aspect: number,
): Camera {
  const [own] = Object.values(ownCameras?.(aspect) ?? {});
  if (own) return own;
  const fovYDegrees = verticalFov(firstView?.fovYDegrees ?? FIRST_LOOK.fovDegrees, aspect);
  if (firstView) return perspectiveCamera({ ...firstView, fovYDegrees, aspect });
  const [subject, extent] = [sphereOf(clouds, 'robustBounds'), sphereOf(clouds, 'bounds')];
  const pose = firstPose(subject, fovYDegrees, aspect, upOf(uprightness));
  return perspectiveCamera({
    ...lookAt(pose),
    ...depthRange(pose, subject, extent),
    fovYDegrees,
    aspect,
  });
}

function sphereOf(clouds: readonly CloudInstance[], part: 'bounds' | 'robustBounds') {
  return boundingSphere(boundsOf(clouds, part));
}

/** The viewer turns a scene that is upside down; here it stays as it is, and the camera turns. */
function upOf({ isUpsideDown, isZUp }: Pick<BenchPathScene, 'isUpsideDown' | 'isZUp'>): Vec3 {
  const up = upVector({ isZUp });
  return isUpsideDown && !isZUp ? [-up[0], -up[1], -up[2]] : up;
}
