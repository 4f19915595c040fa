import { plyKindOf } from '../ply/ply-format.ts';
import type { SplatFormat } from '../splat-format.ts';

/** PLY whose splats are packed in chunks of 256, as SuperSplat and splat-transform write it. */
export const compressedPlyFormat: SplatFormat = {
  name: 'compressed-ply',
  title: 'PLY',
  extensions: ['.compressed.ply'],
  recognise: (firstBytes) => plyKindOf(firstBytes) === 'compressed-ply',
};
