import { linearPart, transform3, type Vec3 } from '../../data/math/mat4.ts';
import type { EffectPlace } from '../../gpu/effects/effect.ts';

/** World position of a point of a cloud that is given about the cloud's origin. */
export function worldPosition([x, y, z]: Vec3, { modelMatrix, origin }: EffectPlace): Vec3 {
  const [px, py, pz] = transform3(linearPart(modelMatrix), [x + origin[0], y + origin[1], z + origin[2]]);
  return [px + modelMatrix[12], py + modelMatrix[13], pz + modelMatrix[14]];
}
