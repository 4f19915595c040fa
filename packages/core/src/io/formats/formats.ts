import { plyFormat } from './ply/ply-format.ts';
import { sogFormat } from './sog/sog-format.ts';
import type { SplatFormat } from './splat-format.ts';
import { zipFormat } from './zip/zip-format.ts';

/**
 * Every format that can be read, in the order in which files are tried. To add one, write its folder, list it here, and give its
 * code to `readers.ts` and its worker to `../loading/format-workers.ts`.
 */
export const SPLAT_FORMATS: readonly SplatFormat[] = [plyFormat, sogFormat, zipFormat];
