import { closeSync, constants, createReadStream, openSync, readSync, type Stats } from 'node:fs';
import { isatty } from 'node:tty';
import { SplatSourceError } from '@websplatter/core';
import { webStreamOf } from './found-file.ts';

/** Bytes that are read from a device at once. */
const READ_BYTES = 1 << 20;
/** Longest wait for a program that writes into a named pipe. Shells start theirs within milliseconds. */
const WRITER_WAIT_MS = 10_000;
/** Shortest and longest wait for more bytes, ms; each wait is twice as long as the one before. */
const LEAST_WAIT_MS = 1;
const MOST_WAIT_MS = 16;
/** Default capacity of a pipe on Linux, bytes. */
const PIPE_BYTES = 1 << 16;

/**
 * Returns a pipe or a device as a stream, which opens it when it is first read. The stream fails with
 * SplatSourceError if a pipe has no writer for 10 s.
 *
 * @param found result of `stat` for the path.
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

/** The error for a terminal, from which reading would wait for keys. */
export function terminalError(path: string): SplatSourceError {
  return new SplatSourceError(path, 'it is a terminal; give a file or a pipe');
}

/** Reads without blocking: a thread that waits for a writer would keep the process from ending. */
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

/** Returns the number of bytes read: 0 if the pipe has no writer, -1 if it has one and is empty. */
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
