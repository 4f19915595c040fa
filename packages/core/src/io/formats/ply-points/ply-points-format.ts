import { plyKindOf } from '../ply/ply-format.ts';
import type { SplatFormat } from '../splat-format.ts';

/** PLY with red, green and blue instead of harmonics: points, and splats as nerfstudio has them. */
export const plyPointsFormat: SplatFormat = {
  name: 'ply-points',
  title: 'PLY',
  extensions: ['.ply'],
  recognise: (firstBytes) => plyKindOf(firstBytes) === 'ply-points',
};
