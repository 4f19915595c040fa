import { ByteReader } from '../../sources/byte-reader.ts';
import { readAll } from '../../sources/read-all.ts';
import { limitsOf } from '../../sources/read-limits.ts';
import type { OpenedSource, ReadOptions } from '../../sources/splat-source.ts';

/** Matches paths of the metadata of streamed SOG. */
export const LEADING = /(?:^|\/)lod-meta\.json$/i;

/**
 * Reads a file by its path relative to the scene's folder. A File that was opened is not read yet.
 *
 * Rejects with SplatFileError 'missing-part', 'damaged', 'too-large'; with SplatSourceError; and
 * with the signal's reason.
 *
 * @param onBytes called with the number of bytes fetched since its last call.
 */
export type ReadSceneFile = (
  path: string,
  signal?: AbortSignal,
  onBytes?: (bytes: number) => void,
) => Promise<Blob>;

/** The files of a streamed SOG. */
export interface SceneFilesOfSog {
  /** Scene name for messages. */
  readonly name: string;
  /** Bytes of `lod-meta.json`. */
  readonly meta: Uint8Array;
  readonly read: ReadSceneFile;
  /** Where `meta` was fetched from; absent for Files. */
  readonly fetched?: OpenedSource['fetched'];
}

/**
 * Reads an opened file, up to `most` bytes.
 *
 * @param onBytes receives the number of bytes so far.
 */
export async function readOpened(
  opened: OpenedSource,
  { signal, maxBytes }: Pick<ReadOptions, 'signal' | 'maxBytes'>,
  most = Number.POSITIVE_INFINITY,
  onBytes?: (loadedBytes: number) => void,
): Promise<Uint8Array<ArrayBuffer>> {
  const reader = new ByteReader(opened, signal, limitsOf({ maxBytes }, opened).maxBytes);
  try {
    const { isLocal, totalBytes } = opened;
    return await readAll(reader, most, isLocal ? Math.min(most, totalBytes ?? 0) : 0, onBytes);
  } finally {
    reader.close();
  }
}
