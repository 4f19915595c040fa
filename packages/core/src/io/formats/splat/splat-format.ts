import { latin1 } from '../latin1.ts';
import { OTHER_FILES } from '../other-files.ts';
import type { SplatFormat } from '../splat-format.ts';

/** First bytes of readable formats that people may name .splat: gzip, zip, Zstandard, .ksplat. */
// biome-ignore lint/suspicious/noControlCharactersInRegex: they tell these formats
const OTHERS = /^(\x1f\x8b\x08|PK\x03\x04|\x28\xb5\x2f\xfd|\0[^\0]\0\0)/;

/** Rows of 32 bytes without a header, as antimatter15's viewer reads them. */
export const splatFormat: SplatFormat = {
  name: 'splat',
  title: '.splat',
  extensions: ['.splat'],
  // No bytes tell it. But no splat consists of letters, as PLY, web pages or pointers to files do. A
  // .gz is unpacked on the way where its server calls gzip its Content-Encoding.
  recognise: (firstBytes, fileName) => {
    const row = latin1(firstBytes.subarray(0, 32));
    if (!/\.splat(?:\.gz)?$/i.test(fileName) || !/[^\t\n\r\x20-\x7e]/.test(row) || OTHERS.test(row))
      return false;
    return !OTHER_FILES.some(({ pattern }) => pattern.test(row));
  },
};
