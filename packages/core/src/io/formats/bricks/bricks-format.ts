import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** With which a file begins. */
export const BRICKS_MAGIC = 'WSBRICKS';

/** Name of the first of the files that one was cut into: see `scene-pieces.ts`. */
export const FIRST_PIECE = /\.bricks\.000$/i;

/** A scene of any size with its levels of detail, in bricks that are read by themselves. */
export const bricksFormat: SplatFormat = {
  name: 'bricks',
  title: '.bricks',
  extensions: ['.bricks'],
  leadingFile: FIRST_PIECE,
  recognise: (firstBytes) => latin1(firstBytes).startsWith(BRICKS_MAGIC),
};
