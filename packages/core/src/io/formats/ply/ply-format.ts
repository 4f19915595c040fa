import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** A chunk with bounds. Any PLY may have an element of that name. */
const COMPRESSED = /\selement chunk \d+(\s+property \w+ \w+)*?\s+property \w+ m(in|ax)_/;
/** A header in which vertices have colours of their own instead of harmonics. */
const POINTS = /^(?!.*\sf_dc_0\s).*\sred\s.*\send_header\s/s;

/** The format of a PLY, by its first bytes; null if these are of none. */
export function plyKindOf(firstBytes: Uint8Array): 'ply' | 'compressed-ply' | 'ply-points' | null {
  const text = latin1(firstBytes);
  if (!/^ply\s/.test(text)) return null;
  if (COMPRESSED.test(text)) return 'compressed-ply';
  return POINTS.test(text) ? 'ply-points' : 'ply';
}

/** PLY as 3D Gaussian Splatting and its descendants write it, and `encodePly`. */
export const plyFormat: SplatFormat = {
  name: 'ply',
  title: 'PLY',
  extensions: ['.ply'],
  recognise: (firstBytes) => plyKindOf(firstBytes) === 'ply',
};
