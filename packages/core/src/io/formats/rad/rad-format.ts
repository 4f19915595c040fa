import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** With which a scene begins, and each of its chunks. */
export const RAD_MAGIC = 'RAD0';
export const CHUNK_MAGIC = 'RADC';

/** Format of Spark: a tree of levels of detail, in chunks of the same file or of files beside it. */
export const radFormat: SplatFormat = {
  name: 'rad',
  title: '.rad',
  extensions: ['.rad'],
  leadingFile: /\.rad$/,
  // Of a chunk alone, the reader says what to open instead.
  recognise: (firstBytes) => [RAD_MAGIC, CHUNK_MAGIC].includes(latin1(firstBytes.subarray(0, 4))),
};
