import { fetched, InvalidArgumentError } from '../../data/errors.ts';
import { given } from '../../data/given.ts';
import { guarded } from '../../data/listeners.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { shown } from '../../data/printable.ts';
import { givenSet } from '../../data/splats/check-set.ts';
import { checkStill } from '../../data/splats/columns.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { buffersIn } from '../remote.ts';
import type { BrickResult, BrickTask, PackZlib } from './bricks/brick-tasks.ts';
import type { BrickWriter, BrickWriterOptions } from './bricks/brick-writer.ts';
import type { FrameWriter, FrameWriterOptions } from './frames/frame-writer.ts';
import type { PartAddress } from './sog/image-addresses.ts';
import { WRITABLE_FORMATS } from './writable-formats.ts';
import type { PutBytes, SplatPieces, WriteFormat, WriteOptions, WritePieces } from './write-format.ts';

/** Loads the writer of each of `WRITABLE_FORMATS`, by path. */
const WRITERS = import.meta.glob<WriteFormat>(['./*/write-*.ts', '!./*/*.test.ts'], { import: 'write' });

/** Loads the writers that can write splats in pieces, by path. */
const PIECE_WRITERS = import.meta.glob<WritePieces>('./{ply,spz}/write-{ply,spz}.ts', {
  import: 'writePieces',
});

/**
 * Writes splats in one of `WRITABLE_FORMATS`, whose code is fetched first. Runs in the calling
 * thread and yields to its event loop.
 *
 * Rejects with `InvalidArgumentError` if the format is unknown ('formatName') or cannot represent
 * these splats ('set'); or with the signal's reason.
 *
 * @example
 * const set = await readSplats('/garden.ply', { shPrecision: 'f32' });
 * const bytes = await writeSplats(set, 'spz', { onNote: (note) => console.log(note) });
 * const file = new File([bytes], 'garden.spz');
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
  checkMotion(givenSet(set).motion, formatName);
  if (givenSet(set).count === 0) throw new InvalidArgumentError('set', 'There are no splats to write.');
  const write = await WRITERS[pathOf(formatName)]();
  return write(set, { ...options, onProgress: guarded(options.onProgress) });
}

/**
 * URLs of the images of a SOG that was fetched by its `meta.json`, for programs that store the
 * scene unchanged, for example with `zipFiles`. All lie in the folder of `meta.json`.
 *
 * Rejects with SplatFileError if the bytes are no metadata of a SOG, or name files outside of its
 * folder.
 *
 * @param meta bytes of its `meta.json`.
 * @param address absolute URL from which `meta.json` was fetched, after redirects.
 * @example
 * const response = await fetch('https://example.org/room/meta.json');
 * const meta = new Uint8Array(await response.arrayBuffer());
 * const images = await sogImageAddresses(meta, response.url);
 */
export async function sogImageAddresses(meta: Uint8Array, address: string): Promise<PartAddress[]> {
  const { imageAddresses } = await fetched('writer', import('./sog/image-addresses.ts'));
  return imageAddresses(meta, address);
}

/**
 * Opens a writer for scenes of any size in bricks; its code is fetched first. See `BrickWriter`.
 *
 * @example
 * const writer = await openBrickWriter();
 * try {
 *   await readSplatPieces(file, { shPrecision: 'f32' }, (piece) => writer.add(piece));
 *   await writer.finish((bytes) => stream.write(bytes));
 * } finally {
 *   await writer.end();
 * }
 */
export async function openBrickWriter(options: BrickWriterOptions = {}): Promise<BrickWriter> {
  const { BrickWriter } = await fetched('writer', import('./bricks/brick-writer.ts'));
  return new BrickWriter(options);
}

/**
 * Opens a writer for the frames of a moving scene; its code is fetched first. See `FrameWriter`.
 *
 * Rejects with `InvalidArgumentError` for options that are out of range.
 *
 * @example
 * const writer = await openFrameWriter({ framesPerS: 24 });
 * for (const frame of files) await writer.add(await readSplats(frame, { shPrecision: 'f32' }));
 * const parts: Uint8Array<ArrayBuffer>[] = [];
 * await writer.finish(async (bytes) => void parts.push(bytes));
 * const file = new File(parts, 'dancer.frames');
 */
export async function openFrameWriter(options: FrameWriterOptions = {}): Promise<FrameWriter> {
  const { FrameWriter } = await fetched('writer', import('./frames/frame-writer.ts'));
  return new FrameWriter(options);
}

/**
 * Runs a task of a `BrickWriter` in any thread. Tasks and results can be posted; `buffers` is the
 * transfer list.
 *
 * @param pack synchronous equivalent of zlib at level 6. Default: the platform's CompressionStream,
 *   which uses other threads.
 *
 * Rejects as the writer.
 *
 * @example
 * // In a worker, for `run` of `openBrickWriter` on the page.
 * onmessage = async ({ data: task }) => {
 *   const { result, buffers } = await runBrickTask(task);
 *   postMessage(result, { transfer: [...buffers] });
 * };
 */
export async function runBrickTask(
  task: BrickTask,
  pack?: PackZlib,
): Promise<{ readonly result: BrickResult; readonly buffers: readonly ArrayBuffer[] }> {
  const { runTask } = await fetched('writer', import('./bricks/brick-tasks.ts'));
  const result = await runTask(task, pack);
  return { result, buffers: [...buffersIn(result)] };
}

/**
 * Whether `writeSplatPieces` supports this format.
 *
 * @example
 * const forLargeScenes = WRITABLE_FORMATS.filter(({ name }) => canWritePieces(name));
 * const options = forLargeScenes.map(({ name, title }) => new Option(title, name));
 */
export function canWritePieces(formatName: string): boolean {
  return pathOf(formatName) in PIECE_WRITERS;
}

/**
 * Writes splats that come in pieces; neither all splats nor the whole file are held in memory.
 * `put` takes the bytes in order. The bytes equal the output of `writeSplats`, except for float64
 * rounding of positions. Some formats read all pieces several times.
 *
 * Rejects with `InvalidArgumentError` if the format cannot be written in pieces ('formatName'), or
 * cannot represent these splats ('set'). Rejects with the signal's reason, and as `pieces.read` and
 * `put` do.
 *
 * @example
 * const options = { shPrecision: 'f32' } as const;
 * const facts = new PieceFacts();
 * await readSplatPieces(file, options, async (piece) => facts.add(piece));
 * await writeSplatPieces(
 *   { facts, read: (onPiece) => readSplatPieces(file, options, onPiece) },
 *   'spz', {}, (bytes) => stream.write(bytes),
 * );
 */
export async function writeSplatPieces(
  pieces: SplatPieces,
  formatName: string,
  options: WriteOptions,
  put: PutBytes,
): Promise<void> {
  if (!canWritePieces(formatName))
    throw new InvalidArgumentError('formatName', `${shown(formatName)} cannot be written in pieces.`);
  checkMotion(pieces.facts.timeRange, formatName);
  if (pieces.facts.count === 0) throw new InvalidArgumentError('set', 'There are no splats to write.');
  const write = await PIECE_WRITERS[pathOf(formatName)]();
  await write(pieces, { ...options, onProgress: guarded(options.onProgress) }, put);
}

function checkMotion(motion: unknown, formatName: string): void {
  const holdsIt = WRITABLE_FORMATS.some(({ name, hasMotion }) => name === formatName && hasMotion);
  if (!holdsIt) checkStill({ motion }, `.${formatName}`);
}

function pathOf(formatName: string): string {
  return `./${formatName}/write-${formatName}.ts`;
}
