import { openFiles } from '../sources/open-files.ts';
import { detectFormat } from './detect.ts';
import type { FormatReaders, ReadFormat } from './splat-format.ts';

/** The code of each format, fetched when a file is of it. */
const READERS: Readonly<Record<string, () => Promise<ReadFormat>>> = {
  'compressed-ply': async () => (await import('./compressed-ply/compressed-ply.ts')).readCompressedPly,
  ksplat: async () => (await import('./ksplat/ksplat.ts')).readKsplat,
  ply: async () => (await import('./ply/ply.ts')).readPly,
  spz: async () => (await import('./spz/spz.ts')).readSpz,
  gzip: async () => (await import('./gzip/gzip.ts')).readGzip,
  gltf: async () => (await import('./gltf/gltf.ts')).readGltf,
  sog: async () => (await import('./sog/sog.ts')).readSog,
  zip: async () => (await import('./zip/zip.ts')).readZip,
  'ply-points': async () => (await import('./ply-points/ply-points.ts')).readPlyPoints,
  splat: async () => (await import('./splat/splat.ts')).readSplat,
};

/** All formats, for threads without a worker. */
export const ALL_READERS: FormatReaders = {
  pick: (firstBytes, file, fileName) => READERS[detectFormat(firstBytes, file, fileName).name](),
  openFiles,
};
