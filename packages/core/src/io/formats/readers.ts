import type { ReadFormat, SplatFormat } from './splat-format.ts';

/** The code of each format, fetched when a file is of it. */
const READERS: Readonly<Record<string, () => Promise<ReadFormat>>> = {
  ply: async () => (await import('./ply/ply.ts')).readPly,
  spz: async () => (await import('./spz/spz.ts')).readSpz,
};

export function readerOf({ name }: SplatFormat): Promise<ReadFormat> {
  return READERS[name]();
}
