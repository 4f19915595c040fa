import { InvalidArgumentError } from '../../data/errors.ts';
import { given } from '../../data/given.ts';
import { guarded } from '../../data/listeners.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { shown } from '../../data/printable.ts';
import { givenSet } from '../../data/splats/check-set.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import type { BrickResult, BrickTask, PackZlib } from './bricks/brick-tasks.ts';
import type { BrickWriter, BrickWriterOptions } from './bricks/brick-writer.ts';
import type { PartAddress } from './sog/image-addresses.ts';
import { WRITABLE_FORMATS } from './writable-formats.ts';
import type { PutBytes, SplatPieces, WriteFormat, WriteOptions, WritePieces } from './write-format.ts';

/** Fetch the code of each of `WRITABLE_FORMATS`, by path. */
const WRITERS = import.meta.glob<WriteFormat>(['./*/write-*.ts', '!./*/*.test.ts'], { import: 'write' });

/** Fetch the code of each format whose writer need not hold all splats, by path. */
const PIECE_WRITERS = import.meta.glob<WritePieces>('./{ply,spz}/write-{ply,spz}.ts', {
  import: 'writePieces',
});

/**
 * Writes splats as a file in the format of this name, one of `WRITABLE_FORMATS`, whose code is
 * fetched first. Works in the calling thread and gives its event loop turns.
 *
 * Rejects with `InvalidArgumentError` if there is no such format ('formatName'), or if it cannot
 * hold these splats ('set'); or with the signal's reason.
 */
export async function writeSplats(
  set: SplatSet<Harmonics>,
  formatName: string,
  options: WriteOptions = {},
): Promise<Uint8Array<ArrayBuffer>> {
  const names = WRITABLE_FORMATS.map(({ name }) => name);
  if (!names.includes(formatName)) {
    const message = `${shown(formatName)} cannot be written; the format must be one of ${names.join(', ')}.`;
    throw new InvalidArgumentError('formatName', message);
  }
  given(options);
  if (givenSet(set).count === 0) throw new InvalidArgumentError('set', 'There are no splats to write.');
  const write = await WRITERS[pathOf(formatName)]();
  return write(set, { ...options, onProgress: guarded(options.onProgress) });
}

/**
 * Addresses of the images that reading a SOG fetches, for a SOG that was fetched itself; all lie in its
 * folder. For programs that keep a scene as it came, by `zipFiles` say.
 *
 * Rejects with SplatFileError if it is no metadata of a SOG, or names files out of its folder.
 *
 * @param meta bytes of its `meta.json`.
 * @param address the absolute one that answered with them.
 * @example
 * const response = await fetch('https://example.org/room/meta.json');
 * const meta = new Uint8Array(await response.arrayBuffer());
 * const images = await sogImageAddresses(meta, response.url);
 */
export async function sogImageAddresses(meta: Uint8Array, address: string): Promise<PartAddress[]> {
  const { imageAddresses } = await import('./sog/image-addresses.ts');
  return imageAddresses(meta, address);
}

/** A writer of scenes of any size in bricks, whose code is fetched first. See `BrickWriter`. */
export async function openBrickWriter(options: BrickWriterOptions = {}): Promise<BrickWriter> {
  const { BrickWriter } = await import('./bricks/brick-writer.ts');
  return new BrickWriter(options);
}

/**
 * Does a part of the work of a `BrickWriter`, in any thread: tasks and results can be posted, with
 * `buffers` in place of copies.
 *
 * @param pack packs as zlib does at level 6, in this thread; by default streams of the platform do,
 *   in others.
 *
 * Rejects as the writer.
 */
export async function runBrickTask(
  task: BrickTask,
  pack?: PackZlib,
): Promise<{ readonly result: BrickResult; readonly buffers: readonly ArrayBuffer[] }> {
  const { buffersOf, runTask } = await import('./bricks/brick-tasks.ts');
  const result = await runTask(task, pack);
  return { result, buffers: [...buffersOf(result)] };
}

/** Whether `writeSplatPieces` writes the format of this name. */
export function canWritePieces(formatName: string): boolean {
  return pathOf(formatName) in PIECE_WRITERS;
}

/**
 * Writes splats that come in pieces as a file, of which `put` takes the bytes from the first to the
 * last: neither all splats nor all of the file are in memory. The bytes equal the result of
 * `writeSplats`, but for rounding of positions in float64. Some formats read all pieces several times.
 *
 * Rejects with `InvalidArgumentError` if the format cannot be written so ('formatName'), or cannot
 * hold these splats ('set'); with the signal's reason; as `pieces.read` and `put` do.
 */
export async function writeSplatPieces(
  pieces: SplatPieces,
  formatName: string,
  options: WriteOptions,
  put: PutBytes,
): Promise<void> {
  if (!canWritePieces(formatName))
    throw new InvalidArgumentError('formatName', `${shown(formatName)} cannot be written in pieces.`);
  if (pieces.facts.count === 0) throw new InvalidArgumentError('set', 'There are no splats to write.');
  const write = await PIECE_WRITERS[pathOf(formatName)]();
  await write(pieces, { ...options, onProgress: guarded(options.onProgress) }, put);
}

function pathOf(formatName: string): string {
  return `./${formatName}/write-${formatName}.ts`;
}
