import { AdjacentReads } from './adjacent-reads.ts';
import { ByteReader } from './byte-reader.ts';
import { FewRequests } from './few-requests.ts';
import { shortName } from './known-source.ts';
import { addressOf, checkRequest, Transfer } from './open-url.ts';
import { blobRanges, type RangeSource } from './range-source.ts';
import { readAll } from './read-all.ts';
import { askFor, type ByteRange, factsOf, noParts, PARTIAL_CONTENT, RemoteFile } from './remote-file.ts';
import type { ReadOptions } from './splat-source.ts';

/** Largest file to keep in memory if a server ignores range requests. */
const MOST_WHOLE_BYTES = 64 << 20;

/**
 * Opens a URL for reads of byte ranges. Adjacent ranges that are requested in the same turn become
 * one request; each resolves once its own bytes have arrived. A broken or stalled request is
 * resumed, if the server can prove that the file is unchanged. Pages may be unable to read
 * Content-Range of another origin; the length is checked then.
 *
 * Rejects as `openUrl`, and with SplatSourceError if a server ignores ranges of a large file.
 *
 * @param firstBytes size of the first request, whose response has the file size.
 * @param requests request queue of the scene.
 */
export async function openUrlRanges(
  url: string,
  firstBytes: number,
  { name = shortName(url), signal, request = {} }: Pick<ReadOptions, 'name' | 'signal' | 'request'>,
  requests = new FewRequests(),
): Promise<RangeSource> {
  const checked = checkRequest(request);
  const address = addressOf(url, name);
  const transfer = new Transfer(address, name, checked, signal);
  if (!transfer.isRemote) return blobRanges(await (await transfer.ask({})).blob(), name);
  const answer = await askFor(transfer, 0, firstBytes);
  if (answer && answer.status !== PARTIAL_CONTENT)
    return blobRanges(new Blob([await readSmall(transfer, answer, name, signal)]), name);
  const { href } = address;
  const remote = { name, url: href, request: checked, facts: answer && factsOf(answer.headers) };
  const file = new RemoteFile(remote);
  const first = await file.receive(transfer, 0, firstBytes, signal, answer);
  const reads = new AdjacentReads<ByteRange, Uint8Array<ArrayBuffer>>((run, end) => {
    const parts = run.map(({ part }) => part);
    return requests.run(() => file.readRun(parts, end, (i, bytes) => run[i].resolve(bytes)), end);
  });
  return {
    name,
    totalBytes: file.totalBytes,
    read: async (offset, byteCount, partSignal) => {
      partSignal?.throwIfAborted();
      const held = first.subarray(offset, offset + byteCount);
      if (held.length === byteCount) return held;
      const left = { offset: offset + held.length, bytes: byteCount - held.length };
      const rest = await reads.read(left, partSignal);
      if (held.length === 0) return rest;
      const bytes = new Uint8Array(held.length + rest.length);
      bytes.set(held);
      bytes.set(rest, held.length);
      return bytes;
    },
    remote: { ...remote, heldBytes: first.length },
  };
}

/** Reads a response that has the whole file. */
async function readSmall(
  transfer: Transfer,
  answer: Response,
  name: string,
  signal: AbortSignal | undefined,
): Promise<Uint8Array<ArrayBuffer>> {
  const opened = transfer.openAnswer(answer);
  const reader = new ByteReader(opened, signal);
  try {
    const isLarge = opened.totalBytesCertain && (opened.totalBytes ?? 0) > MOST_WHOLE_BYTES;
    const bytes = isLarge ? null : await readAll(reader, MOST_WHOLE_BYTES + 1);
    if (bytes && bytes.length <= MOST_WHOLE_BYTES) return bytes;
    throw noParts(
      name,
      `the server answered ${answer.status} with the whole file, of more than 64 MiB`,
      answer.status,
    );
  } finally {
    reader.close();
  }
}
