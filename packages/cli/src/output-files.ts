import { constants } from 'node:fs';
import { access, type FileHandle, open, stat } from 'node:fs/promises';
import { dirname } from 'node:path';
import { WebSplatterError } from '@websplatter/core';
import type { Console } from './console.ts';
import { describeSystemError, InputFileError, ReaderLeftError, UsageError } from './input-error.ts';
import { identityOf, type OutputPlace, outputPlace, STDIN_FD, STDIO, STDOUT_FD } from './output-place.ts';
import { isForbidden, PartFiles, tryPart } from './part-files.ts';
import { noteLeftParts } from './part-names.ts';

/** Where a command writes a file. */
export interface Output {
  /** Its name on the command line, such as `--out`. */
  readonly argument: string;
  /** A file, a pipe, a device, or `-`, which is standard output. */
  readonly path: string;
}

/** Puts the bytes of a file, from the first to the last. */
export type PutContent = (put: (bytes: Uint8Array) => Promise<void>) => Promise<void>;

export interface OutputFile extends Output {
  readonly content: Uint8Array | string | PutContent;
}

/** Bytes that are written at once. */
const PIECE_BYTES = 1 << 20;

/**
 * Checks a command's outputs, standard output included. To be called before any work is done.
 *
 * @param inputs files that are read; `-` is standard input.
 *
 * Rejects with InputFileError for outputs that cannot be written; with UsageError for any that are
 * also an input or another output, by any name.
 */
export async function checkOutputs(outputs: readonly Output[], inputs: Iterable<string>): Promise<void> {
  const uses = new Map<string, string>();
  let stdinUses = 0;
  for (const input of inputs) {
    if (input === STDIO && ++stdinUses > 1)
      throw new UsageError('arguments', 'standard input, -, can be read only once');
    // The reader of a missing input reports it.
    const identity = await identityOf(input, STDIN_FD).catch(() => undefined);
    if (identity !== undefined) uses.set(identity, 'is read');
  }
  const stdout = await identityOf(STDIO, STDOUT_FD);
  if (stdout !== undefined && uses.has(stdout))
    throw new UsageError('standard output', 'standard output is a file that is read too');
  for (const { argument, path } of outputs) {
    await checkWritable(path);
    const identity = await identityOf(path, STDOUT_FD);
    if (identity === undefined) continue;
    const use = uses.get(identity);
    if (use) throw new UsageError(argument, `${argument} is ${path}, which ${use} too; give it another name`);
    uses.set(identity, `${argument} writes`);
  }
}

async function checkWritable(path: string): Promise<void> {
  if (path === STDIO) return;
  const folder = dirname(path);
  const found = await stat(folder).catch((error) => {
    throw new InputFileError(path, `cannot be written: ${describeSystemError(error)}`, `folder ${folder}`, {
      cause: error,
    });
  });
  if (!found.isDirectory())
    throw new InputFileError(path, 'cannot be written: it would lie in a file', `folder ${folder}`);
  try {
    const place = await outputPlace(path);
    if (place.found?.isDirectory()) throw new InputFileError(path, 'cannot be written: it is a folder');
    if (place.found?.isSocket()) throw new InputFileError(path, 'cannot be written: it is a socket');
    if (place.kind !== 'stdout' && place.found) await access(place.path, constants.W_OK);
    if (place.kind === 'file') tryFolder(place);
  } catch (error) {
    throw asOutputError(path, error);
  }
}

/** A file that is there can be written into where none can be put beside it. */
function tryFolder({ path, found }: OutputPlace): void {
  try {
    tryPart(dirname(path));
  } catch (error) {
    if (!found || !isForbidden(error)) throw error;
  }
}

/** Says which incomplete files lie where a command writes; see `noteLeftParts`. */
export async function noteLeftOutputs(outputs: readonly Output[], console: Console): Promise<void> {
  const places = await Promise.all(outputs.map(({ path }) => outputPlace(path)));
  const files = places.filter(({ kind }) => kind === 'file');
  await noteLeftParts(
    files.map(({ path }) => dirname(path)),
    console,
  );
}

/** Where a command reports its work: on standard error if one of its outputs is standard output. */
export async function reportBeside(paths: readonly string[], console: Console): Promise<Console['out']> {
  const places = await Promise.all(paths.map(outputPlace));
  return places.some(({ kind }) => kind === 'stdout') ? console.err : console.out;
}

/**
 * Writes files under temporary names in the folders of their destinations, and renames them once all
 * are complete. A replaced file passes on its mode and owner. Links are followed. Pipes and devices
 * are written into.
 *
 * Rejects as `checkOutputs`, with InputFileError, and with ReaderLeftError; no destination file has
 * changed then.
 */
export async function writeFiles(files: readonly OutputFile[], inputs: Iterable<string>): Promise<void> {
  await checkOutputs(files, inputs);
  const parts = new PartFiles();
  const whole: OutputPlace[] = [];
  const others: [OutputPlace, OutputFile['content']][] = [];
  let current = '';
  try {
    for (const { path, content } of files) {
      current = path;
      const place = await outputPlace(path);
      const part = place.kind === 'file' ? await parts.open(place) : null;
      if (part) {
        await writeAndClose(part, content);
        whole.push(place);
      } else others.push([place, content]);
    }
    for (const [place, content] of others) {
      current = place.path;
      await writeInto(place, content);
    }
    for (const place of whole) {
      current = place.path;
      await parts.finish(place);
    }
  } catch (error) {
    throw asOutputError(current, error);
  } finally {
    parts.end();
  }
}

function asOutputError(path: string, error: unknown): WebSplatterError {
  if (error instanceof WebSplatterError) return error;
  return new InputFileError(path, `cannot be written: ${describeSystemError(error)}`, undefined, {
    cause: error,
  });
}

async function writeInto({ kind, path }: OutputPlace, content: OutputFile['content']): Promise<void> {
  if (kind === 'stdout') return putContent(content, putOnStdout);
  // A file that is open elsewhere goes on where it ends. One that nothing can replace starts anew.
  const flag = kind === 'stream' ? constants.O_APPEND : constants.O_TRUNC;
  await writeAndClose(await open(path, constants.O_WRONLY | flag), content);
}

async function writeAndClose(file: FileHandle, content: OutputFile['content']): Promise<void> {
  try {
    await putContent(content, (bytes) => file.writeFile(bytes));
  } finally {
    await file.close();
  }
}

/** Puts the content of a file. */
export async function putContent(
  content: OutputFile['content'],
  put: Parameters<PutContent>[0],
): Promise<void> {
  if (typeof content === 'function') return content(put);
  const bytes = typeof content === 'string' ? Buffer.from(content) : content;
  for (let at = 0; at < bytes.length; at += PIECE_BYTES) await put(bytes.subarray(at, at + PIECE_BYTES));
}

function putOnStdout(bytes: Uint8Array): Promise<void> {
  return new Promise((resolve, reject) => {
    process.stdout.write(bytes, (cause) => {
      if (!cause) return resolve();
      const hasLeft = (cause as NodeJS.ErrnoException).code === 'EPIPE';
      reject(hasLeft ? new ReaderLeftError({ cause }) : cause);
    });
  });
}
