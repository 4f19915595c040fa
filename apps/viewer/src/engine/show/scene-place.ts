import type { ScenePlace } from '@websplatter/core/effect-options';
import { LEAST_DISTANCE_RADII } from '../../camera/framing.ts';
import type { Vec3 } from '../../state/vec3.ts';
import type { Viewer } from '../viewer.ts';

/** How far away cameras usually are, in radii of their subject. */
const USUAL_DEPTH = 2;

/**
 * The region that effect sliders cover: the scene, or the target of its first view if that is much
 * smaller. Captures have a far background, which would make sliders too coarse.
 */
export function scenePlaceOf({ camera, shownFrame }: Pick<Viewer, 'camera' | 'shownFrame'>): ScenePlace {
  const { target, distance } = camera.controls.home;
  const sphere = camera.subjectSphere ?? { center: target, radius: 1 };
  const isWithin = distance < LEAST_DISTANCE_RADII * sphere.radius;
  const { center, radius } = isWithin ? { center: target, radius: distance / USUAL_DEPTH } : sphere;
  const viewMatrix = shownFrame?.frame.camera.viewMatrix;
  const depth = viewMatrix ? depthIn(viewMatrix, center) : USUAL_DEPTH * radius;
  return { center, radius, viewDepth: Math.max(depth, radius) };
}

function depthIn(viewMatrix: ArrayLike<number>, [x, y, z]: Vec3): number {
  return -(viewMatrix[2] * x + viewMatrix[6] * y + viewMatrix[10] * z + viewMatrix[14]);
}
