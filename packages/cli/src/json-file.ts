import { shown as printed, WebSplatterError } from '@websplatter/core';
import { openStdin, streamFile } from '@websplatter/node';
import { describeSystemError, InputFileError } from './input-error.ts';
import { STDIO } from './output-place.ts';

/** A camera or a matrix has a few hundred bytes: a device without end is to be refused at once. */
const MOST_BYTES = 16 << 20;

/** Reads a JSON file, a pipe, or standard input for `-`; `kind` names its purpose in messages. */
export async function readJsonFile(file: string, kind: string): Promise<unknown> {
  let text: string;
  try {
    text = await textOf(file === STDIO ? openStdin() : await streamFile(file), file);
  } catch (error) {
    if (error instanceof WebSplatterError) throw error;
    throw new InputFileError(file, `the ${kind} cannot be read: ${describeSystemError(error)}`, undefined, {
      cause: error,
    });
  }
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new InputFileError(file, `the ${kind} is not JSON: ${(error as Error).message}`, undefined, {
      cause: error,
    });
  }
}

async function textOf(stream: ReadableStream<Uint8Array<ArrayBuffer>>, file: string): Promise<string> {
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  let bytes = 0;
  for await (const piece of stream) {
    pieces.push(piece);
    bytes += piece.length;
    if (bytes > MOST_BYTES)
      throw new InputFileError(
        file,
        `it has more than ${MOST_BYTES} bytes: that is no JSON of a camera or a matrix`,
      );
  }
  return new Blob(pieces).text();
}

/** Formats a value for a message: short, on one line. */
export function shown(value: unknown): string {
  return value === undefined ? 'nothing' : printed(typeof value === 'string' ? `"${value}"` : value);
}

export function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/** Whether `value` is an array of `length` finite numbers. */
export function isNumbers(value: unknown, length: number): value is number[] {
  return Array.isArray(value) && value.length === length && value.every((each) => Number.isFinite(each));
}
