import { SplatFileError } from '../../../data/errors.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { readAll } from '../../sources/read-all.ts';
import { limitsOf } from '../../sources/read-limits.ts';
import type { OpenedSource, ReadOptions, SplatSource } from '../../sources/splat-source.ts';

/** The files of a streamed SOG. */
export interface SceneParts {
  /** Scene name for messages. */
  readonly name: string;
  /** Bytes of `lod-meta.json`. */
  readonly meta: Uint8Array;
  /**
   * Opens a file together with its neighbours, by its path relative to the scene's folder.
   *
   * Rejects with SplatFileError 'missing-part', 'damaged', 'too-large'.
   */
  readonly open: (path: string) => Promise<SplatSource>;
}

/** Matches paths of the metadata of streamed SOG. */
export const LEADING = /(?:^|\/)lod-meta\.json$/i;

/** Maps paths relative to the folder of `leading` to full paths. Null if `leading` is not in the list. */
export function pathsBeside(leading: string, paths: readonly string[]): Map<string, string> | null {
  const folder = folderOf(leading);
  const images = paths.filter((path) => path.startsWith(folder) && !/\.json$/i.test(path));
  if (!paths.includes(leading)) return null;
  return new Map([
    [leading, 'meta.json'],
    ...images.map((path) => [path, path.slice(folder.length)] as const),
  ]);
}

/** Reads an opened file, up to `most` bytes. */
export async function readOpened(
  opened: OpenedSource,
  { signal, maxBytes }: Pick<ReadOptions, 'signal' | 'maxBytes'>,
  most = Number.POSITIVE_INFINITY,
): Promise<Uint8Array<ArrayBuffer>> {
  const reader = new ByteReader(opened, signal, limitsOf({ maxBytes }, opened).maxBytes);
  try {
    const { isHeld, totalBytes } = opened;
    return await readAll(reader, most, isHeld ? Math.min(most, totalBytes ?? 0) : 0);
  } finally {
    reader.close();
  }
}

/** The error for a file that its scene lacks. */
export function missingPart(path: string, name: string): SplatFileError {
  const message = `it needs ${path}, which is not among the files that were opened. Open them all together.`;
  return new SplatFileError('missing-part', name, message);
}
