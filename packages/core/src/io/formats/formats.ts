import { bricksFormat } from './bricks/bricks-format.ts';
import { compressedPlyFormat } from './compressed-ply/compressed-ply-format.ts';
import { gltfFormat } from './gltf/gltf-format.ts';
import { gzipFormat } from './gzip/gzip-format.ts';
import { ksplatFormat } from './ksplat/ksplat-format.ts';
import { plyFormat } from './ply/ply-format.ts';
import { plyPointsFormat } from './ply-points/ply-points-format.ts';
import { radFormat } from './rad/rad-format.ts';
import { sogFormat } from './sog/sog-format.ts';
import { splatFormat } from './splat/splat-format.ts';
import type { SplatFormat } from './splat-format.ts';
import { spzFormat } from './spz/spz-format.ts';
import { zipFormat } from './zip/zip-format.ts';

/**
 * Every format that can be read, in the order in which files are tried and people are told of them:
 * common ones first, archives last. To add one, write its folder, and list it here; if it has
 * several files, list its code in `readers.ts`.
 */
export const SPLAT_FORMATS: readonly SplatFormat[] = [
  compressedPlyFormat,
  plyFormat,
  plyPointsFormat,
  spzFormat,
  sogFormat,
  gltfFormat,
  radFormat,
  // By its name only: it leaves files that others know by their first bytes to those below.
  splatFormat,
  ksplatFormat,
  bricksFormat,
  zipFormat,
  gzipFormat,
];

export { FIRST_PIECE } from '../../data/bricks/brick-files.ts';

/** Names of the formats for people, each once. */
export const FORMAT_TITLES: readonly string[] = [...new Set(SPLAT_FORMATS.map(({ title }) => title))];

/** Whether a file with this name, without folders, leads to the others of its scene. */
export function isLeadingFile(fileName: string): boolean {
  const lower = fileName.toLowerCase();
  return SPLAT_FORMATS.some(({ leadingFile }) => leadingFile?.test(lower));
}

/** The format that files with this name usually have; undefined if the name does not tell. */
export function formatByName(fileName: string): SplatFormat | undefined {
  const lower = fileName.toLowerCase();
  return SPLAT_FORMATS.find(
    ({ extensions, leadingFile }) =>
      extensions.some((end) => lower.endsWith(end)) || leadingFile?.test(lower),
  );
}
