import { InvalidArgumentError } from '../../../data/errors.ts';
import { given, wrongArgument } from '../../../data/given.ts';
import { dropNonFinite } from '../../../data/packing/drop-non-finite.ts';
import type { Harmonics } from '../../../data/packing/harmonics.ts';
import { mortonOrder, permuteSplats } from '../../../data/packing/morton-order.ts';
import { givenSet } from '../../../data/splats/check-set.ts';
import { checkStill } from '../../../data/splats/columns.ts';
import { agreedAntialiasing, type SplatSet } from '../../../data/splats/splat-set.ts';
import { crc32 } from '../../containers/crc32.ts';
import { packZlib } from '../../containers/pack-gzip.ts';
import type { PutBytes } from '../write-format.ts';
import type { KeyFrame } from './decode-frame.ts';
import { packColumns } from './frame-columns.ts';
import {
  FRAME_RATES,
  type FrameEntry,
  headerBytesOf,
  isFrameRate,
  KEY_HEAD_BYTES,
  keyHeadBytes,
  MOST_FRAMES,
  writeHeader,
} from './frames-layout.ts';
import { quantiseDifference, quantiseKey } from './quantise-frame.ts';

/** Rate and key frames of a `FrameWriter`. */
export interface FrameWriterOptions {
  /** Frames per second of playback, 0.001 to 1000. Default: 30. */
  readonly framesPerS?: number;
  /**
   * Most frames from one key frame to the next. Fewer make a seek quicker where splats move far; more make
   * the file smaller. Default: 30.
   */
  readonly keyEvery?: number;
}

const DEFAULT_FRAMES_PER_S = 30;
const DEFAULT_KEY_EVERY = 30;

/** The last key frame, with what tells whether a frame has the same splats. */
interface LastKey {
  readonly key: KeyFrame;
  readonly number: number;
  readonly bytes: number;
  /** Storage order of the key frame. */
  readonly order: Uint32Array;
  readonly fileIndices: Uint32Array;
}

/**
 * Writes the frames of a moving scene as one file. A frame with the rows of the frame before it, in their
 * order, is written as the difference to a key frame. Another number of rows begins a new key frame, and
 * so does a frame whose difference would not be smaller. Frames are held compressed until `finish`.
 *
 * @example
 * const writer = await openFrameWriter({ framesPerS: 24 });
 * for (const file of files) await writer.add(await readSplats(file, { shPrecision: 'f32' }));
 * await writer.finish((bytes) => stream.write(bytes));
 */
export class FrameWriter {
  readonly framesPerS: number;
  readonly #keyEvery: number;
  readonly #entries: Omit<FrameEntry, 'offset'>[] = [];
  readonly #parts: Uint8Array<ArrayBuffer>[] = [];
  readonly #antialiasing: { readonly isAntialiased: boolean | undefined }[] = [];
  #last: LastKey | null = null;

  /** @throws InvalidArgumentError for numbers that are out of range. */
  constructor(options: FrameWriterOptions = {}) {
    const { framesPerS = DEFAULT_FRAMES_PER_S, keyEvery = DEFAULT_KEY_EVERY } = given(options);
    if (!isFrameRate(framesPerS)) throw wrongArgument('framesPerS', framesPerS, FRAME_RATES);
    if (!(Number.isInteger(keyEvery) && keyEvery > 0))
      throw wrongArgument('keyEvery', keyEvery, 'a whole number above 0');
    this.framesPerS = framesPerS;
    this.#keyEvery = keyEvery;
  }

  /** Frames so far. */
  get frameCount(): number {
    return this.#entries.length;
  }

  /** Key frames so far. */
  get keyCount(): number {
    return this.#entries.filter(({ key }, i) => key === i).length;
  }

  /** Whether all frames so far were trained with an antialias filter; undefined if they do not agree. */
  get isAntialiased(): boolean | undefined {
    return this.frameCount > 0 ? agreedAntialiasing(this.#antialiasing) : undefined;
  }

  /**
   * Adds the next frame. Rows that are not finite are dropped, which begins a new key frame.
   *
   * Rejects with `InvalidArgumentError` if the frame has no splats or its splats move, or if the file has 4,194,304
   * frames.
   */
  async add(frame: SplatSet<Harmonics>): Promise<void> {
    checkStill(givenSet(frame, 'frame'), 'a frame');
    const set = dropNonFinite(frame);
    const number = this.frameCount;
    if (set.count === 0)
      throw new InvalidArgumentError('frame', `Frame ${number} has no splats. Leave it out.`);
    if (number === MOST_FRAMES)
      throw new InvalidArgumentError('frame', `A file holds ${MOST_FRAMES} frames at most. Begin another.`);
    this.#antialiasing.push({ isAntialiased: set.isAntialiased });
    const last = this.#last;
    const isFollowing = last && number - last.number < this.#keyEvery && hasSameRows(set, last);
    if (!(isFollowing && (await this.#addDifference(set, last)))) await this.#addKey(set);
  }

  /**
   * Writes the file. `put` takes the bytes in order.
   *
   * Rejects with `InvalidArgumentError` if there are no frames, and as `put`.
   */
  async finish(put: PutBytes): Promise<void> {
    if (this.frameCount === 0)
      throw new InvalidArgumentError('frames', 'There are no frames to write. Add at least one.');
    let offset = headerBytesOf(this.frameCount);
    const entries = this.#entries.map((entry) => {
      const placed = { ...entry, offset };
      offset += entry.bytes;
      return placed;
    });
    const { framesPerS, isAntialiased } = this;
    await put(writeHeader({ framesPerS, isAntialiased, entries }));
    for (const part of this.#parts) await put(part);
  }

  /** Returns false if the frame is to be a key frame. */
  async #addDifference(set: SplatSet<Harmonics>, last: LastKey): Promise<boolean> {
    const difference = quantiseDifference(permuteSplats(set, last.order), last.key);
    if (!difference) return false;
    const unpacked = packColumns(difference, set.count);
    const packed = await packZlib(unpacked);
    if (packed.length >= last.bytes) return false;
    this.#push(last.key, last.number, unpacked, packed);
    return true;
  }

  async #addKey(set: SplatSet<Harmonics>): Promise<void> {
    const order = mortonOrder(set.positions, set.count);
    const key = quantiseKey(permuteSplats(set, order));
    const columns = packColumns(key.columns, set.count);
    const headBytes = keyHeadBytes(set.count);
    const unpacked = new Uint8Array(headBytes + columns.length);
    const view = new DataView(unpacked.buffer);
    for (const [axis, value] of key.origin.entries()) view.setFloat64(8 * axis, value, true);
    for (const [i, value] of key.chunks.entries()) view.setFloat32(KEY_HEAD_BYTES + 4 * i, value, true);
    unpacked.set(columns, headBytes);
    const packed = await packZlib(unpacked);
    const number = this.frameCount;
    this.#last = { key, number, bytes: packed.length, order, fileIndices: set.fileIndices };
    this.#push(key, number, unpacked, packed);
  }

  #push(
    { splatCount, shDegree }: KeyFrame,
    key: number,
    unpacked: Uint8Array,
    packed: Uint8Array<ArrayBuffer>,
  ): void {
    const [bytes, unpackedBytes] = [packed.length, unpacked.length];
    this.#parts.push(packed);
    this.#entries.push({ bytes, unpackedBytes, crc: crc32(packed), key, splatCount, shDegree });
  }
}

/** Whether rows correspond: a row that was dropped from one frame alone shifts those after it. */
function hasSameRows({ count, harmonics, fileIndices }: SplatSet<Harmonics>, last: LastKey): boolean {
  if (count !== last.key.splatCount || harmonics.degree !== last.key.shDegree) return false;
  return fileIndices.every((row, i) => row === last.fileIndices[i]);
}
