import { compressedPlyFormat } from '../compressed-ply/compressed-ply-format.ts';
import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** PLY as written by 3D Gaussian Splatting and its descendants; also the file that `encodePly` writes. */
export const plyFormat: SplatFormat = {
  name: 'ply',
  title: 'PLY',
  extensions: ['.ply'],
  recognise: (firstBytes, fileName) =>
    /^ply\s/.test(latin1(firstBytes)) && !compressedPlyFormat.recognise(firstBytes, fileName),
};
