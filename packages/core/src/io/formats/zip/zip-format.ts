import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** A zip archive with a scene in it; `.sog` is one. */
export const zipFormat: SplatFormat = {
  name: 'zip',
  title: 'zip',
  extensions: ['.sog', '.zip'],
  recognise: (firstBytes) => latin1(firstBytes).startsWith('PK\x03\x04'),
};
