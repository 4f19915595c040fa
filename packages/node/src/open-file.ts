import { constants, createReadStream } from 'node:fs';
import { access, open, readdir, stat } from 'node:fs/promises';
import { basename, dirname, join, relative } from 'node:path';
import { Readable } from 'node:stream';
import { ReadableStream as WebStream } from 'node:stream/web';
import type { SplatSource } from '@websplatter/core';
import { FIRST_PIECE, isLeadingFile } from '@websplatter/core/formats';

/** Bytes that are read from a file at once. */
const READ_BYTES = 1 << 20;
type OnFile = ((path: string) => void) | undefined;

/** Most files that are looked at beside one that leads to others. */
const MOST_PARTS = 10_000;

/**
 * A file as a source of splats: one of any size, which can be read again, or a pipe, which can be
 * read once. Node's own `openAsBlob` takes sizes modulo 4 GiB. A file that leads to others, such as
 * `meta.json`, comes with those of its folder; a folder is opened by such a file.
 *
 * @param onFile told of this file, and of each other one when it is read.
 * @throws the system's error (`code`, e.g. `ENOENT`, `EACCES`, or `EISDIR` for a folder without
 * one) if the file cannot be read.
 */
export async function openFile(path: string, onFile?: OnFile): Promise<SplatSource> {
  const found = await stat(path);
  if (found.isDirectory()) {
    const leading = (await readdir(path)).find(isLeadingFile);
    if (leading !== undefined) return openFile(join(path, leading), onFile);
    throw Object.assign(new Error(`${path} is a folder, not a file`), { code: 'EISDIR' });
  }
  await access(path, constants.R_OK);
  onFile?.(path);
  if (!found.isFile()) return streamOf(path);
  if (FIRST_PIECE.test(path)) return openPieces(path, onFile);
  return isLeadingFile(basename(path)) ? openFolder(path, onFile) : fileOf(path, found.size, onFile);
}

/** The standard input of this process, once. */
export function openStdin(): ReadableStream<Uint8Array<ArrayBuffer>> {
  return webStreamOf(process.stdin);
}

/** The file at `leading` with those that it may lead to, itself first. */
async function openFolder(leading: string, onFile: OnFile): Promise<SplatSource> {
  const folder = dirname(leading);
  const paths = [leading];
  const folders = [folder];
  for (const each of folders) {
    for (const entry of await readdir(each, { withFileTypes: true })) {
      const path = join(each, entry.name);
      if (entry.isDirectory()) folders.push(path);
      else if (entry.isFile() && path !== join(leading)) paths.push(path);
    }
    if (paths.length > MOST_PARTS) break;
  }
  const files = await Promise.all(paths.map(async (path) => fileOf(path, (await stat(path)).size, onFile)));
  return { files, paths: paths.map((path) => relative(folder, path).replaceAll('\\', '/')) };
}

/** The pieces that a file was cut into, as that file. */
async function openPieces(first: string, onFile: OnFile): Promise<Blob> {
  const stem = first.slice(0, -'000'.length);
  const pieces: { readonly path: string; readonly start: number; readonly end: number }[] = [];
  let size = 0;
  for (;;) {
    const path = `${stem}${String(pieces.length).padStart(3, '0')}`;
    const found = await stat(path).catch(() => null);
    if (!found) break;
    pieces.push({ path, start: size, end: size + found.size });
    size += found.size;
  }
  async function* contents() {
    for (const { path } of pieces) {
      onFile?.(path);
      yield* createReadStream(path, { highWaterMark: READ_BYTES });
    }
  }
  const slice = (start: number, end: number) => {
    const within = pieces.filter((piece) => piece.start < end && piece.end > start);
    const parts = within.map((piece) =>
      partOf(piece.path, Math.max(0, start - piece.start), Math.min(end, piece.end) - piece.start),
    );
    const arrayBuffer = async () =>
      new Blob(await Promise.all(parts.map((part) => part.arrayBuffer()))).arrayBuffer();
    return { arrayBuffer };
  };
  const stream = () => webStreamOf(Readable.from(contents(), { objectMode: false }));
  return { name: basename(stem.slice(0, -1)), size, stream, slice } as unknown as Blob;
}

/** The part of a File that readers need. */
function fileOf(path: string, size: number, onFile: OnFile): Blob {
  const stream = () => {
    onFile?.(path);
    return streamOf(path);
  };
  const slice = (start = 0, end = size) => partOf(path, start, Math.min(end, size));
  return { name: basename(path), size, stream, slice } as unknown as Blob;
}

/** Bytes `start` to `end` of a file. */
function partOf(path: string, start: number, end: number): Blob {
  const arrayBuffer = async () => {
    const file = await open(path);
    try {
      const bytes = new Uint8Array(Math.max(0, end - start));
      const { bytesRead } = await file.read(bytes, 0, bytes.length, start);
      return bytes.buffer.slice(0, bytesRead);
    } finally {
      await file.close();
    }
  };
  return { size: Math.max(0, end - start), arrayBuffer } as unknown as Blob;
}

function streamOf(path: string): ReadableStream<Uint8Array<ArrayBuffer>> {
  return webStreamOf(createReadStream(path, { highWaterMark: READ_BYTES }));
}

/** `Readable.toWeb` gives a stream that throws outside of every promise if cancelled while full. */
function webStreamOf(readable: Readable): ReadableStream<Uint8Array<ArrayBuffer>> {
  return WebStream.from<Uint8Array>(readable) as ReadableStream<Uint8Array<ArrayBuffer>>;
}
