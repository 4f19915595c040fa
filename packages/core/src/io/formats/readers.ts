import type { ReadFormat, SplatFormat } from './splat-format.ts';

/** The code of each format, fetched when a file is of it. */
const READERS: Readonly<Record<string, () => Promise<ReadFormat>>> = {
  ply: async () => (await import('./ply/ply.ts')).readPly,
  sog: async () => (await import('./sog/sog.ts')).readSog,
  zip: async () => (await import('./zip/zip.ts')).readZip,
};

export function readerOf({ name }: SplatFormat): Promise<ReadFormat> {
  return READERS[name]();
}
