import { cropSplats } from '../data/editing/crop-splats.ts';
import { limitDegree } from '../data/editing/limit-degree.ts';
import { transformSplats } from '../data/editing/transform-splats.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { everyOf, stillLife } from './still-life.ts';

/**
 * An object alone in empty space, as captures of objects are: small, flat splats of degree 2, y
 * down, 2 across, about 0. Seven thousand splats, cropped from a still life, or every `step`th of
 * them.
 */
export async function objectScene(step = 1): Promise<SplatSet<Harmonics>> {
  const still = limitDegree(await stillLife(), 2);
  const object = cropSplats(still, { min: [-0.6, -0.3, -0.6], max: [0.6, 0.9, 0.6] });
  return transformSplats(everyOf(object, step), {
    rotation: [0, 1, 0, 0],
    scale: 1.6,
    translation: [0, 0.7, 0],
  });
}
