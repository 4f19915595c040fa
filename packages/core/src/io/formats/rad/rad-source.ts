import { SplatSourceError } from '../../../data/errors.ts';
import { FewRequests } from '../../sources/few-requests.ts';
import type { KnownSource } from '../../sources/known-source.ts';
import { openFiles } from '../../sources/open-files.ts';
import { openRanges } from '../../sources/open-ranges.ts';
import { addressOf } from '../../sources/open-url.ts';
import { truncated } from '../../sources/read-all.ts';
import { openPart, readOpenedPart } from '../../sources/read-part.ts';
import type { ReadOptions } from '../../sources/splat-source.ts';
import { latin1, RAD_MAGIC } from '../first-bytes.ts';
import { checkPath } from '../scene-file-reader.ts';
import { type RadHeader, readRadHeader } from './rad-header.ts';

/** Size of the first read: it covers the header of a scene of a hundred million nodes. */
const FIRST_BYTES = 1 << 17;
/** HTTP status of a complete response. */
const OK = 200;

/** A scene whose chunks can be read separately. */
export interface RadSource {
  readonly name: string;
  readonly header: RadHeader;
  /**
   * Reads a chunk. Rejects as `openRad`.
   *
   * @param onBytes called with the number of bytes since its last call.
   */
  readonly read: (
    chunk: number,
    signal?: AbortSignal,
    onBytes?: (bytes: number) => void,
  ) => Promise<Uint8Array<ArrayBuffer>>;
}

/**
 * Null for streams, other files, and a large .rad on a server without range requests. Rejects as
 * `openRad`.
 */
export async function openRadSource(
  source: KnownSource,
  options: Omit<ReadOptions, 'onProgress'>,
): Promise<RadSource | null> {
  const { signal, request, maxBytes } = options;
  if (source.kind === 'stream' || source.kind === 'frame') return null;
  const requests = new FewRequests();
  const ranges = await openRanges(source, FIRST_BYTES, options, requests).catch((error) => {
    if (error instanceof SplatSourceError && error.status === OK) return null;
    throw error;
  });
  if (!ranges || latin1(await ranges.read(0, RAD_MAGIC.length, signal)) !== RAD_MAGIC) return null;
  const { name, totalBytes } = ranges;
  const readAt = async (startByte: number, byteCount: number, what: string, end = signal) => {
    const check = (foundBytes: number) => {
      if (foundBytes < byteCount) throw truncated(name, what, { startByte, byteCount, foundBytes });
    };
    if (totalBytes !== undefined) check(Math.max(0, totalBytes - startByte));
    const bytes = await ranges.read(startByte, byteCount, end);
    check(bytes.length);
    return bytes;
  };
  let at = 0;
  const header = await readRadHeader(name, async (byteCount, what) => {
    at += byteCount;
    return readAt(at - byteCount, byteCount, what);
  });
  const scene = {
    name,
    ...(source.kind === 'url' && {
      fetched: { url: addressOf(source.url, name).href, request: request ?? {} },
    }),
    ...(source.kind === 'files' && { openPart: openFiles(source, options).openPart }),
  };
  const read: RadSource['read'] = async (chunk, end, onBytes) => {
    const { path, offset, bytes: byteCount } = header.chunks[chunk];
    if (path === null) {
      const bytes = await readAt(header.bytes + offset, byteCount, `chunk ${chunk}`, end);
      onBytes?.(bytes.length);
      return bytes;
    }
    checkPath(path, name);
    const partOptions = { signal: end, maxBytes };
    let before = 0;
    const count = (loadedBytes: number) => {
      onBytes?.(loadedBytes - before);
      before = loadedBytes;
    };
    const readFile = async () =>
      readOpenedPart(await openPart(scene, path, partOptions), partOptions, () => count);
    return requests.run(readFile, end);
  };
  return { name, header, read };
}
