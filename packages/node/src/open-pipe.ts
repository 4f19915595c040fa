import { closeSync, constants, createReadStream, openSync, readSync, type Stats } from 'node:fs';
import { isatty } from 'node:tty';
import { SplatSourceError } from '@websplatter/core';
import { webStreamOf } from './found-file.ts';

/** Bytes that are read from a device at once. */
const READ_BYTES = 1 << 20;
/** Longest wait for a program that writes into a named pipe. Shells start theirs within milliseconds. */
const WRITER_WAIT_MS = 10_000;
/** Waits for more bytes, each twice as long as the last. */
const LEAST_WAIT_MS = 1;
const MOST_WAIT_MS = 16;
/** As much as a pipe holds on Linux. */
const PIPE_BYTES = 1 << 16;

/**
 * What is no file as a stream: a pipe or a device, opened once it is read. A pipe without a writer
 * fails the stream with SplatSourceError after 10 s.
 *
 * @param found what `stat` says of it.
 * @throws SplatSourceError for a socket or a terminal; the system's error.
 */
export function openPipe(path: string, found: Stats): ReadableStream<Uint8Array<ArrayBuffer>> {
  if (found.isSocket())
    throw new SplatSourceError(path, 'it is a socket; give a file or a pipe, or - for standard input');
  if (found.isCharacterDevice()) checkNoTerminal(path);
  return webStreamOf(
    found.isFIFO() ? pipeContents(path) : createReadStream(path, { highWaterMark: READ_BYTES }),
  );
}

function checkNoTerminal(path: string): void {
  const fd = openSync(path, constants.O_RDONLY | constants.O_NONBLOCK | constants.O_NOCTTY);
  try {
    if (isatty(fd)) throw terminalError(path);
  } finally {
    closeSync(fd);
  }
}

/** For what would wait for keys. */
export function terminalError(path: string): SplatSourceError {
  return new SplatSourceError(path, 'it is a terminal; give a file or a pipe');
}

/** Nothing blocks: a thread that waits for a writer would keep the process from ending. */
async function* pipeContents(path: string): AsyncGenerator<Uint8Array> {
  const fd = openSync(path, constants.O_RDONLY | constants.O_NONBLOCK);
  try {
    let hasWriter = false;
    let waitMs = LEAST_WAIT_MS;
    for (let waitedMs = 0; ; waitedMs += waitMs) {
      const bytes = new Uint8Array(PIPE_BYTES);
      const count = readNow(fd, bytes);
      if (count > 0) {
        yield bytes.subarray(0, count);
        waitMs = LEAST_WAIT_MS;
      } else if (count === 0 && hasWriter) return;
      else if (count === 0 && waitedMs >= WRITER_WAIT_MS) throw noWriterError(path);
      else {
        await new Promise((resolve) => setTimeout(resolve, waitMs));
        waitMs = Math.min(2 * waitMs, MOST_WAIT_MS);
      }
      hasWriter ||= count !== 0;
    }
  } finally {
    closeSync(fd);
  }
}

/** The count of bytes read: 0 if nobody has the pipe open for writing, -1 if somebody has and no bytes are there. */
function readNow(fd: number, bytes: Uint8Array): number {
  try {
    return readSync(fd, bytes);
  } catch (error) {
    if ((error as NodeJS.ErrnoException).code === 'EAGAIN') return -1;
    throw error;
  }
}

function noWriterError(path: string): SplatSourceError {
  const message = `it is a pipe, and nothing has written to it for ${WRITER_WAIT_MS / 1000} s; start what writes first`;
  return new SplatSourceError(path, message);
}
