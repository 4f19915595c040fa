import { stillLife } from '@websplatter/scenes';
import { cropSplats } from '../editing/crop-splats.ts';
import { transformSplats } from '../editing/transform-splats.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import type { SplatSet } from '../splats/splat-set.ts';

/**
 * An object alone in empty space, as captures of objects are: small, flat splats of degree 2, y down, 2 across, about 0. Seven in
 * ten of the `splats` of a still life, which is cut off from what surrounds it.
 */
export function objectScene(splats: number): SplatSet<Harmonics> {
  const still = stillLife({ splats, shDegree: 2 });
  const object = cropSplats(still, { min: [-0.6, -0.3, -0.6], max: [0.6, 0.9, 0.6] });
  return transformSplats(object, { rotation: [0, 1, 0, 0], scale: 1.6, translation: [0, 0.7, 0] });
}
