import { constants, createReadStream } from 'node:fs';
import { access, stat } from 'node:fs/promises';
import { Readable } from 'node:stream';
import type { SplatSource } from '@websplatter/core';

/** Bytes that are read from a file at once. */
const READ_BYTES = 1 << 20;

/**
 * A file as a source of splats: one of any size, which can be read again, or a pipe, which can be read once. Node's own
 * `openAsBlob` takes sizes modulo 4 GiB.
 *
 * @throws the system's error (`code`, e.g. `ENOENT`, `EACCES` or `EISDIR`) if the file cannot be read.
 */
export async function openFile(path: string): Promise<SplatSource> {
  const found = await stat(path);
  if (found.isDirectory())
    throw Object.assign(new Error(`${path} is a folder, not a file`), { code: 'EISDIR' });
  await access(path, constants.R_OK);
  const stream = () =>
    Readable.toWeb(createReadStream(path, { highWaterMark: READ_BYTES })) as ReadableStream<Uint8Array>;
  return found.isFile() ? ({ size: found.size, stream } as Blob) : stream();
}
