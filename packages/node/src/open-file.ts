import { constants } from 'node:fs';
import { access, readdir, stat } from 'node:fs/promises';
import { basename, dirname, join, relative } from 'node:path';
import type { SplatSource } from '@websplatter/core';
import { FIRST_PIECE, isLeadingFile } from '@websplatter/core/formats';
import { type FoundFile, findFile, webStreamOf } from './found-file.ts';
import { openPipe, terminalError } from './open-pipe.ts';

type OnFile = ((path: string) => void) | undefined;

/** Most files of a folder that `meta.json` and the like may refer to. */
const MOST_PARTS = 10_000;

/**
 * Opens a file as a source of splats. Files have any size and can be read again; pipes can be read
 * once. A file that refers to others, such as `meta.json`, includes the files of its folder; a folder
 * is opened by such a file. Not Node's `openAsBlob`, which takes sizes modulo 4 GiB.
 *
 * Reading the source rejects with SplatSourceError if a file has changed since it was opened, or if
 * no program writes to the pipe.
 *
 * @param onFile called with the path of this file, and of each further file when it is read.
 * @throws the system's error (`code`, e.g. `ENOENT`, `EACCES`, or `EISDIR` for a folder without such a
 *   file) if the file cannot be read; SplatSourceError if it is a socket or a terminal.
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
  if (!found.isFile()) return openPipe(path, found);
  if (FIRST_PIECE.test(path)) return openPieces(path, onFile);
  if (isLeadingFile(basename(path))) return openFolder(path, onFile);
  return (await findFile(path, onFile && (() => onFile(path)))).asBlob();
}

/**
 * Returns a stream of one file or pipe, without interpreting its name. The stream fails like readings
 * of `openFile`.
 *
 * @throws as `openFile`.
 */
export async function streamFile(path: string): Promise<ReadableStream<Uint8Array<ArrayBuffer>>> {
  const found = await stat(path);
  if (found.isDirectory())
    throw Object.assign(new Error(`${path} is a folder, not a file`), { code: 'EISDIR' });
  return found.isFile() ? (await findFile(path)).asBlob().stream() : openPipe(path, found);
}

/** Returns standard input as a stream. @throws SplatSourceError if it is a terminal. */
export function openStdin(): ReadableStream<Uint8Array<ArrayBuffer>> {
  if (process.stdin.isTTY) throw terminalError('standard input');
  return webStreamOf(process.stdin);
}

/** Returns the file at `leading` and the files that it may refer to, itself first. */
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
  const found = await Promise.all(paths.map((path) => findIfThere(path, onFile)));
  // Files may disappear after `readdir`, such as temporary files of a program that writes here.
  const files = found.filter((file) => file !== null);
  return {
    files: files.map((file) => file.asBlob()),
    paths: files.map(({ path }) => relative(folder, path).replaceAll('\\', '/')),
  };
}

async function findIfThere(path: string, onFile: OnFile): Promise<FoundFile | null> {
  try {
    return await findFile(path, onFile && (() => onFile(path)));
  } catch (error) {
    if ((error as NodeJS.ErrnoException).code === 'ENOENT') return null;
    throw error;
  }
}

/** Returns the pieces of a split file as one Blob. */
async function openPieces(first: string, onFile: OnFile): Promise<Blob> {
  const stem = first.slice(0, -'000'.length);
  const pieces: { readonly file: FoundFile; readonly start: number; readonly end: number }[] = [];
  let size = 0;
  for (;;) {
    const file = await findIfThere(`${stem}${String(pieces.length).padStart(3, '0')}`, onFile);
    if (!file) break;
    pieces.push({ file, start: size, end: size + file.size });
    size += file.size;
  }
  async function* contents() {
    for (const { file } of pieces) yield* file.contents();
  }
  const slice = (start: number, end: number) => {
    const within = pieces.filter((piece) => piece.start < end && piece.end > start);
    const parts = within.map((piece) =>
      piece.file.part(Math.max(0, start - piece.start), Math.min(end, piece.end) - piece.start),
    );
    const arrayBuffer = async () =>
      new Blob(await Promise.all(parts.map((part) => part.arrayBuffer()))).arrayBuffer();
    return { arrayBuffer };
  };
  const stream = () => webStreamOf(contents());
  return { name: basename(stem.slice(0, -1)), size, stream, slice } as unknown as Blob;
}
