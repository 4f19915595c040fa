import { type EffectUse, fog, type RevealOptions } from '@websplatter/core/effects';
import type { Box3, Camera, Object3D, Scene } from 'three/webgpu';
import { clippingOf } from './clipping-groups.ts';
import { isAnimation, type RevealAnimation } from './reveal-animation.ts';
import { revealUse } from './reveal-use.ts';
import { sceneFog } from './scene-fog.ts';

/** The part of a cloud that decides its effects. */
interface CloudInScene extends Object3D {
  readonly reveal: RevealAnimation | RevealOptions | null;
  readonly fog: boolean;
  readonly worldBounds: Box3;
}

/**
 * Returns the effects of a cloud in a scene: its own, the reveal animation, clipping groups, and the
 * scene's fog unless the cloud has its own.
 *
 * @param own effects that the cloud has in any scene.
 * @param progress part of the reveal animation's time that has passed; complete from 1 on.
 * @throws InvalidArgumentError for fog or planes that effects cannot take.
 */
export function sceneEffects(
  cloud: CloudInScene,
  own: readonly EffectUse[],
  progress: number,
  scene: Scene,
  camera: Camera,
): EffectUse[] {
  const { reveal } = cloud;
  const uses = [...own, ...clippingOf(cloud)];
  if (reveal && isAnimation(reveal) && progress < 1)
    uses.push(revealUse(reveal, progress, cloud.worldBounds, camera));
  const takesFog = cloud.fog && !own.some(({ effect }) => effect === fog.effect);
  return takesFog ? [...uses, ...sceneFog(scene)] : uses;
}
