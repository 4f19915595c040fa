import { SplatFileError } from '../../../data/errors.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { readAll } from '../../sources/read-all.ts';
import { limitsOf } from '../../sources/read-limits.ts';
import type { OpenedSource, ReadOptions, SplatSource } from '../../sources/splat-source.ts';

/** The files of a streamed SOG. */
export interface SceneParts {
  /** For messages. */
  readonly name: string;
  /** Bytes of `lod-meta.json`. */
  readonly meta: Uint8Array;
  /**
   * A source of a file with all that lies beside it, by its path from the folder of the scene.
   *
   * Rejects with SplatFileError 'missing-part', 'damaged', 'too-large'.
   */
  readonly open: (path: string) => Promise<SplatSource>;
}

/** Paths of the metadata of streamed SOG. */
export const LEADING = /(?:^|\/)lod-meta\.json$/i;

/** Of paths in the folder of one: what they are from there. Null if that one is missing. */
export function pathsBeside(leading: string, paths: readonly string[]): Map<string, string> | null {
  const folder = folderOf(leading);
  const images = paths.filter((path) => path.startsWith(folder) && !/\.json$/i.test(path));
  if (!paths.includes(leading)) return null;
  return new Map([
    [leading, 'meta.json'],
    ...images.map((path) => [path, path.slice(folder.length)] as const),
  ]);
}

/** Reads what has been opened, up to `most` bytes. */
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

/** The error for a file that is not among those of its scene. */
export function missingPart(path: string, name: string): SplatFileError {
  const message = `it needs ${path}, which is not among the files that were opened. Open them all together.`;
  return new SplatFileError('missing-part', name, message);
}
