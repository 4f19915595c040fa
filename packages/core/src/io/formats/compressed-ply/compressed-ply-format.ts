import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** PLY whose splats are packed in chunks of 256, as SuperSplat and splat-transform write it. */
export const compressedPlyFormat: SplatFormat = {
  name: 'compressed-ply',
  title: 'compressed PLY',
  extensions: ['.compressed.ply'],
  // Any PLY may have an element of that name; only this one has bounds in it.
  recognise: (firstBytes) =>
    /^ply\s.*\selement chunk \d+(\s+property \w+ \w+)*?\s+property \w+ m(in|ax)_/s.test(latin1(firstBytes)),
};
