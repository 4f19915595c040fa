import { SplatSourceError } from '../../data/errors.ts';
import { ByteReader } from './byte-reader.ts';
import { checkRequest } from './check-request.ts';
import { type AnswerFacts, addressOf, bodyOf, cancelBody, isPacked, partOf, Transfer } from './open-url.ts';
import { blobRanges, type RangeSource } from './range-source.ts';
import { readAll } from './read-all.ts';
import { shortName } from './source-kind.ts';
import type { ReadOptions, RequestOptions } from './splat-source.ts';

/** The status of an answer with a part of a file, and where there is no such part. */
const PARTIAL_CONTENT = 206;
const NO_SUCH_RANGE = 416;

/**
 * Opens an address, of which each part is a request. A part that breaks off is asked for again. A
 * page is not always told which part another origin sends: its length must be right then.
 *
 * Rejects as `openUrl`, and with SplatSourceError where a server sends no parts of files.
 *
 * @param firstBytes asked for at once, which tell the size of the file.
 */
export async function openUrlRanges(
  url: string,
  firstBytes: number,
  { name = shortName(url), signal, request = {} }: Pick<ReadOptions, 'name' | 'signal' | 'request'>,
): Promise<RangeSource> {
  const checked = checkRequest(request);
  const address = addressOf(url, name);
  const transfer = new Transfer(address, name, checked, signal);
  if (!transfer.isRemote) return blobRanges(await (await transfer.ask({})).blob(), name);
  const nothing: Part = { bytes: new Uint8Array(0), validator: null, totalBytes: 0 };
  const first = (await readPart(transfer, name, checked, 0, firstBytes, signal)) ?? nothing;
  const { validator, totalBytes } = first;
  return {
    name,
    totalBytes,
    read: async (offset, byteCount, partSignal) => {
      if (offset + byteCount <= first.bytes.length) {
        partSignal?.throwIfAborted();
        return first.bytes.subarray(offset, offset + byteCount);
      }
      const again = new Transfer(address, name, checked, partSignal);
      const part = await readPart(again, name, checked, offset, byteCount, partSignal);
      if (part === null) return nothing.bytes;
      const isSame =
        part.validator === validator &&
        (part.totalBytes === undefined || totalBytes === undefined || part.totalBytes === totalBytes);
      if (isSame) return part.bytes;
      throw new SplatSourceError(name, 'the file has changed on its server meanwhile. Open it again.');
    },
  };
}

interface Part extends AnswerFacts {
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** Null where the file ends before that part. */
async function readPart(
  transfer: Transfer,
  name: string,
  { idleTimeoutMs }: Required<RequestOptions>,
  offset: number,
  byteCount: number,
  signal: AbortSignal | undefined,
): Promise<Part | null> {
  for (;;) {
    const response = await askFor(transfer, offset, byteCount);
    if (response === null) return null;
    const { startsAt, validator, totalBytes } = partOf(response.headers);
    const isWhole = response.status !== PARTIAL_CONTENT;
    if (isWhole || isPacked(response.headers) || (startsAt !== null && startsAt !== offset)) {
      cancelBody(response);
      const found = isWhole
        ? `the server answered ${response.status} with the whole file`
        : 'the server sent another part than it was asked for, or packed it';
      const advice = 'Host it where range requests are answered, or pass the file itself';
      throw new SplatSourceError(name, `${found}, but a scene in bricks is read in parts. ${advice}.`);
    }
    const reader = new ByteReader({ name, stream: bodyOf(response), idleTimeoutMs }, signal);
    try {
      const bytes = await readAll(reader, byteCount);
      const endsBefore = totalBytes !== undefined && offset + byteCount > totalBytes;
      const expected = endsBefore ? totalBytes - offset : byteCount;
      if (bytes.length === expected || totalBytes === undefined) return { bytes, validator, totalBytes };
      await transfer.waitAfter(
        new SplatSourceError(name, `the transfer broke off after ${bytes.length} of ${expected} bytes`),
      );
    } catch (failure) {
      if (!(failure instanceof SplatSourceError)) throw failure;
      await transfer.waitAfter(failure);
    } finally {
      reader.close();
    }
  }
}

/** Null where the file ends before that part. */
async function askFor(transfer: Transfer, offset: number, byteCount: number): Promise<Response | null> {
  try {
    return await transfer.ask({ range: `bytes=${offset}-${offset + byteCount - 1}` });
  } catch (error) {
    if (error instanceof SplatSourceError && error.status === NO_SUCH_RANGE) return null;
    throw error;
  }
}
