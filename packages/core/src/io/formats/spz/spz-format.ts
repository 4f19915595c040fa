import { isGzip } from '../gzip/gzip-format.ts';
import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** Before version 4, packed contents begin with it. */
export const SPZ_MAGIC = 'NGSP';

/** SPZ by Niantic, versions 1 to 4; before version 4, all of the file is packed by gzip. */
export const spzFormat: SplatFormat = {
  name: 'spz',
  title: 'SPZ',
  extensions: ['.spz'],
  recognise: (firstBytes, fileName) =>
    latin1(firstBytes.subarray(0, 4)) === SPZ_MAGIC || (isGzip(firstBytes) && /\.spz$/i.test(fileName)),
};
