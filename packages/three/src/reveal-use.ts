import { type EffectUse, reveal } from '@websplatter/core/effects';
import { type Box3, type Camera, Vector3 } from 'three/webgpu';
import type { RevealAnimation } from './reveal-animation.ts';

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
