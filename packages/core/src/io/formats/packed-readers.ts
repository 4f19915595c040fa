import { readCompressedPly } from './compressed-ply/compressed-ply.ts';
import { compressedPlyFormat } from './compressed-ply/compressed-ply-format.ts';
import { readGltf } from './gltf/gltf.ts';
import { gltfFormat } from './gltf/gltf-format.ts';
import { readKsplat } from './ksplat/ksplat.ts';
import { ksplatFormat } from './ksplat/ksplat-format.ts';
import { readPly } from './ply/ply.ts';
import { plyFormat } from './ply/ply-format.ts';
import { readPlyPoints } from './ply-points/ply-points.ts';
import { plyPointsFormat } from './ply-points/ply-points-format.ts';
import { readSplat } from './splat/splat.ts';
import { splatFormat } from './splat/splat-format.ts';
import type { ReadFormat, SplatFormat } from './splat-format.ts';
import { readSpz } from './spz/spz.ts';
import { spzFormat } from './spz/spz-format.ts';

export interface FormatReader {
  readonly format: SplatFormat;
  readonly read: ReadFormat;
}

/** Formats of a single file, which people pack by gzip and zip, in the order in which they are tried. */
export const PACKED_READERS: readonly FormatReader[] = [
  { format: compressedPlyFormat, read: readCompressedPly },
  { format: plyFormat, read: readPly },
  { format: plyPointsFormat, read: readPlyPoints },
  { format: spzFormat, read: readSpz },
  { format: gltfFormat, read: readGltf },
  { format: splatFormat, read: readSplat },
  { format: ksplatFormat, read: readKsplat },
];

/** What people call them, each once. */
export const PACKED_TITLES: readonly string[] = [
  ...new Set(PACKED_READERS.map(({ format }) => format.title)),
];

/** The code that reads what was packed; undefined if it is of none of these formats. See `SplatFormat.recognise`. */
export function packedReaderOf(firstBytes: Uint8Array, fileName: string): ReadFormat | undefined {
  return PACKED_READERS.find(({ format }) => format.recognise(firstBytes, fileName))?.read;
}

/** Whether a file with this name, in lower case, is usually of one of these formats. */
export function isPackedScene(fileName: string): boolean {
  return PACKED_READERS.some(({ format }) => format.extensions.some((end) => fileName.endsWith(end)));
}
