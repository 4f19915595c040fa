import { createReadStream } from 'node:fs';
import { mkdir, open, stat } from 'node:fs/promises';
import { basename, join } from 'node:path';
import type { Console } from './console.ts';
import { describeSystemError, InputFileError, UsageError } from './input-error.ts';
import { noteLeftOutputs, type OutputFile, writeFiles } from './output-files.ts';
import { parseStrictly } from './render-options.ts';

const PIECE_BYTES = 4 << 20;
const MAGIC = 'WSBRICKS';

/** `websplatter split IN.bricks FOLDER`. */
export async function split(args: readonly string[], console: Console): Promise<void> {
  const { positionals } = parseStrictly(args, {});
  if (positionals.length !== 2)
    throw new UsageError(
      'FOLDER',
      `split needs an IN.bricks and a FOLDER, found ${positionals.length} of them`,
    );
  const [scene, folder] = positionals;
  const bytes = await checkBricks(scene);
  const pieceCount = Math.ceil(bytes / PIECE_BYTES);
  const pathOf = (index: number) => join(folder, `${nameOf(scene)}.${String(index).padStart(3, '0')}`);
  const pieces = Array.from({ length: pieceCount }, (_, index): OutputFile => {
    const start = index * PIECE_BYTES;
    const content: OutputFile['content'] = async (put) => {
      for await (const part of createReadStream(scene, { start, end: start + PIECE_BYTES - 1 }))
        await put(part);
    };
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

/** Size of a file in bricks. @throws InputFileError; SplatFileError if it is none. */
async function checkBricks(path: string): Promise<number> {
  try {
    const file = await open(path);
    try {
      const { buffer } = await file.read(Buffer.alloc(MAGIC.length), 0, MAGIC.length, 0);
      if (buffer.toString('latin1') !== MAGIC)
        throw new InputFileError(path, 'it is no .bricks file; make one by websplatter convert first');
      return (await file.stat()).size;
    } finally {
      await file.close();
    }
  } catch (error) {
    if (error instanceof InputFileError) throw error;
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
