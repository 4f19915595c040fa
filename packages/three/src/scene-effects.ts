import { type EffectUse, fog, type RevealOptions, reveal } from '@websplatter/core/effects';
import { type Box3, type Camera, type Object3D, type Scene, Vector3 } from 'three/webgpu';
import { clippingOf } from './clipping-groups.ts';
import { isAnimation, type RevealAnimation } from './reveal-animation.ts';
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

/** Default width of the band that fades in, as a part of the radius. */
const SOFT_PART = 0.3;

/**
 * Returns the effect that shows the part of a cloud that is revealed by now. Its radius grows with
 * the cube of time, so that near splats appear visibly however far the scene reaches, until the
 * farthest corner of the cloud's bounds has faded in.
 *
 * @param progress 0…1, the part of the animation's time that has passed.
 * @param bounds the cloud's, in world space.
 */
export function revealUse(
  { from, softEdge, grow }: RevealAnimation,
  progress: number,
  bounds: Box3,
  camera: Camera,
): EffectUse {
  const start =
    from === 'camera' ? new Vector3().setFromMatrixPosition(camera.matrixWorld) : new Vector3(...from);
  // The bounds of a cloud without splats are infinite and inside out.
  const farthest = new Vector3().max(bounds.max.clone().sub(start)).max(start.sub(bounds.min)).length();
  const end = softEdge === undefined ? farthest / (1 - SOFT_PART) : farthest + softEdge;
  const radius = end * progress ** 3;
  return reveal({ from, radius, softEdge: softEdge ?? SOFT_PART * radius, grow });
}
