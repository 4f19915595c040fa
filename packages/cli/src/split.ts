import { mkdir, stat } from 'node:fs/promises';
import { basename, join } from 'node:path';
import { WebSplatterError } from '@websplatter/core';
import { type FoundFile, findFile } from '@websplatter/node';
import type { Console } from './console.ts';
import { describeSystemError, InputFileError, UsageError } from './input-error.ts';
import { parseArguments } from './options.ts';
import { noteLeftOutputs, type OutputFile, type PutContent, writeFiles } from './output-files.ts';

const PIECE_BYTES = 4 << 20;
const MAGIC = 'WSBRICKS';

/** `websplatter split IN.bricks FOLDER`. */
export async function split(args: readonly string[], console: Console): Promise<void> {
  const { positionals } = parseArguments(args, {});
  if (positionals.length !== 2)
    throw new UsageError(
      'FOLDER',
      `split needs an IN.bricks and a FOLDER, found ${positionals.length} of them`,
    );
  const [scene, folder] = positionals;
  const file = await findBricks(scene);
  const bytes = file.size;
  const pieceCount = Math.ceil(bytes / PIECE_BYTES);
  const pathOf = (index: number) => join(folder, `${nameOf(scene)}.${String(index).padStart(3, '0')}`);
  const pieces = Array.from({ length: pieceCount }, (_, index): OutputFile => {
    const start = index * PIECE_BYTES;
    const end = Math.min(bytes, start + PIECE_BYTES);
    const content: PutContent = async (put) => put(new Uint8Array(await file.part(start, end).arrayBuffer()));
    return { argument: 'FOLDER', path: pathOf(index), content };
  });
  await mkdir(folder, { recursive: true }).catch((cause) => {
    throw new InputFileError(folder, `cannot be made: ${describeSystemError(cause)}`, undefined, { cause });
  });
  // A reader of all pieces in the folder would take it for the end of this scene.
  if (await stat(pathOf(pieceCount)).catch(() => null))
    throw new UsageError('FOLDER', `${pathOf(pieceCount)} is of a larger scene; remove its pieces first`);
  await noteLeftOutputs(pieces, console);
  await writeFiles(pieces, [scene]);
  console.out(`${pathOf(0)}: ${pieceCount} ${pieceCount === 1 ? 'piece' : 'pieces'}, ${bytes} bytes\n`);
}

/** A file in bricks, to be read. @throws InputFileError for any other. */
async function findBricks(path: string): Promise<FoundFile> {
  try {
    if (!(await stat(path)).isFile())
      throw new InputFileError(path, 'it is no file; split needs a .bricks file');
    const file = await findFile(path);
    const magic = Buffer.from(await file.part(0, MAGIC.length).arrayBuffer()).toString('latin1');
    if (magic === MAGIC) return file;
    throw new InputFileError(path, 'it is no .bricks file; make one by websplatter convert first');
  } catch (error) {
    if (error instanceof WebSplatterError) throw error;
    throw new InputFileError(path, `cannot be read: ${describeSystemError(error)}`, undefined, {
      cause: error,
    });
  }
}

/** Readers know pieces by this end. */
function nameOf(path: string): string {
  const name = basename(path);
  return /\.bricks$/i.test(name) ? name : `${name}.bricks`;
}
