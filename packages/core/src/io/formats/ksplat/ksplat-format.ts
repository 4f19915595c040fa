import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** Format of GaussianSplats3D: sections of splats in buckets, in three levels of compression. */
export const ksplatFormat: SplatFormat = {
  name: 'ksplat',
  title: '.ksplat',
  extensions: ['.ksplat'],
  // No magic number, but version 0.x, a level below 3, and a header that is 0 from byte 44 on.
  recognise: (firstBytes, fileName) => {
    const text = latin1(firstBytes);
    // biome-ignore lint/suspicious/noControlCharactersInRegex: the header consists of them
    if (/^\0[^\0].{18}[\0-\x02]\0.{22}\0{200}/s.test(text)) return true;
    return /\.ksplat(?:\.gz)?$/i.test(fileName) && /[^\t\n\r\x20-\x7e]/.test(text.slice(0, 32));
  },
};
