import { FIRST_PIECE } from '../../../data/bricks/brick-files.ts';
import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** With which a file begins. */
export const BRICKS_MAGIC = 'WSBRICKS';

/** A scene of any size with its levels of detail, in bricks that are read by themselves. */
export const bricksFormat: SplatFormat = {
  name: 'bricks',
  title: '.bricks',
  extensions: ['.bricks'],
  leadingFile: FIRST_PIECE,
  recognise: (firstBytes) => latin1(firstBytes).startsWith(BRICKS_MAGIC),
};
