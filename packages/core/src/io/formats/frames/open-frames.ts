import { guarded } from '../../../data/listeners.ts';
import { checkPrecision } from '../../../data/packing/check-precision.ts';
import { packHarmonics, repackHarmonics } from '../../../data/packing/repack-harmonics.ts';
import { SceneWorkers } from '../../loading/scene-workers.ts';
import { KeptReads } from '../../sources/kept-reads.ts';
import { knownSource } from '../../sources/known-source.ts';
import { openRanges } from '../../sources/open-ranges.ts';
import { limitsOf, unpackedLimit } from '../../sources/read-limits.ts';
import type { ReadOptions, SplatFrame, SplatSource } from '../../sources/splat-source.ts';
import { checkCount } from '../rows/splat-counts.ts';
import {
  checkUnpacked,
  type FrameEntry,
  factsOf,
  HEADER_BYTES,
  headerBytesOf,
  readFrameCount,
  readHeader,
} from './frames-layout.ts';
import type { FrameBytes } from './pack-frame.ts';

/** Bytes of the first request: the header of a thousand frames, and the beginning of the first frame. */
const FIRST_BYTES = 1 << 16;
/** Bytes that are requested beyond a frame, so that a slow line does not delay each frame. */
const AHEAD_BYTES = 1 << 20;
/** Compressed frames in memory. Loops within them are fetched once. */
const KEPT_BYTES = 64 << 20;

/** An opened file of frames. Its frames can be loaded in any order. */
export interface SplatFrames {
  /** Name of the file, for messages. */
  readonly name: string;
  /** The frames in order: sources for `engine.load`, `SplatLoader` and `SplatSequence`. */
  readonly frames: readonly SplatFrame[];
  readonly framesPerS: number;
  /** Duration of all frames, seconds. */
  readonly durationS: number;
  /** Size of the file. */
  readonly bytes: number;
  /** Ends the workers of the file. Pending and later loads of its frames reject with DestroyedError. */
  end(): void;
}

/** Number of the next key frame that is opened, in this thread. */
let nextId = 0;

/**
 * Options of `openFrames`. `onProgress` is called as frames of a server are requested and arrive. Its rate leaves
 * out the time in which nothing is requested, and it counts no splats.
 */
export type OpenFramesOptions = Omit<ReadOptions, 'format'>;

/**
 * Opens a file of frames, which `convert` of the command line and `openFrameWriter` write. The header is read
 * now, each frame on request: from a server by range requests, a megabyte ahead. Workers decode frames.
 *
 * Rejects with SplatSourceError if the file cannot be fetched, or is large and its server ignores ranges;
 * with SplatFileError if it is no file of frames or is damaged; with InvalidArgumentError if the
 * source is a stream or invalid; and with the signal's reason.
 *
 * @example
 * const { frames, framesPerS } = await openFrames('/dancer.frames');
 * const third = await engine.load(frames[2]);
 * label.textContent = `at ${2 / framesPerS} s of ${frames.length / framesPerS} s`;
 */
export async function openFrames(source: SplatSource, options: OpenFramesOptions = {}): Promise<SplatFrames> {
  const from = knownSource(source, options);
  const { signal } = options;
  const ranges = await openRanges(from, FIRST_BYTES, options);
  const { name: file } = ranges;
  const head = await ranges.read(0, HEADER_BYTES, signal);
  const headerBytes = headerBytesOf(readFrameCount(head, file));
  const header = readHeader(await ranges.read(0, headerBytes, signal), file);
  const { entries, framesPerS, isAntialiased } = header;
  const { maxSplats } = limitsOf(options, { isLocal: !ranges.remote });
  for (const entry of entries) {
    checkCount(entry.splatCount, file, maxSplats);
    checkUnpacked(entry, file, unpackedLimit(options, ranges));
  }
  const workers = new SceneWorkers(from.name);
  const kept = new KeptReads<Uint8Array<ArrayBuffer>>(KEPT_BYTES, (bytes) => bytes.length);
  const ending = new AbortController();
  const firstId = nextId;
  nextId += entries.length;
  const { bytes: totalBytes } = factsOf(header).frames;
  const progress = new FrameProgress({ headerBytes, totalBytes }, options.onProgress);
  const bytesOf = (number: number, until?: AbortSignal) => {
    const { offset, bytes } = entries[number];
    const load = async (end: AbortSignal) => {
      const read = ranges.read(offset, bytes, end);
      // Copied, because a view would be posted with all bytes around it.
      return (await (ranges.remote ? progress.during(number, read) : read)).slice();
    };
    return kept.read(number, load, until);
  };
  const prefetch = (number: number) => {
    if (!ranges.remote) return;
    let ahead = 0;
    for (let i = number + 1; i < entries.length && ahead < AHEAD_BYTES; i++) {
      ahead += entries[i].bytes;
      // The frame's own load reports the error.
      bytesOf(i, ending.signal).catch(() => {});
    }
  };
  const facts = {
    ...(isAntialiased !== undefined && { isAntialiased }),
    fileFacts: factsOf(header),
  };
  const fetchFrame = async (number: number, until?: AbortSignal): Promise<FrameBytes> => {
    until?.throwIfAborted();
    const { key } = entries[number];
    const packed = async (each: number) => ({
      ...{ file, number: each, entry: entries[each] },
      bytes: await bytesOf(each, until),
    });
    const reads = [packed(key), key === number ? null : packed(number)] as const;
    // In the same turn, so that one request brings them all.
    prefetch(number);
    const [keyFrame, difference] = await Promise.all(reads);
    return { id: firstId + key, key: keyFrame, difference, facts };
  };
  const frameOf = (_: FrameEntry, number: number): SplatFrame => ({
    name: `${file}, frame ${number}`,
    loadFrame: async (precision, until) => {
      checkPrecision(precision);
      const frame = await fetchFrame(number, until);
      return workers.call('packFrame', { frame, precision }, { signal: until });
    },
    readFrame: async (shPrecision, until) => {
      const frame = await fetchFrame(number, until);
      const set = await workers.call('readFrame', { frame }, { signal: until });
      const harmonics = repackHarmonics(packHarmonics(set.harmonics), set.count, shPrecision);
      return { ...set, harmonics };
    },
  });
  return {
    name: file,
    frames: entries.map(frameOf),
    framesPerS,
    durationS: entries.length / framesPerS,
    bytes: totalBytes,
    end: () => {
      ending.abort();
      void workers.end();
    },
  };
}

/** Counts the bytes of frames that have arrived, and the time in which some are awaited. */
class FrameProgress {
  readonly #sizes: { readonly headerBytes: number; readonly totalBytes: number };
  readonly #onProgress: ReadOptions['onProgress'];
  readonly #arrived = new Set<number>();
  #frameBytes = 0;
  /** Includes frames that were evicted and fetched again. */
  #fetchedBytes = 0;
  #awaited = 0;
  #awaitedSinceMs = 0;
  #awaitedMs = 0;

  constructor(
    sizes: { readonly headerBytes: number; readonly totalBytes: number },
    onProgress: ReadOptions['onProgress'],
  ) {
    this.#sizes = sizes;
    this.#onProgress = guarded(onProgress);
  }

  /** Returns the bytes of a frame; reports when they are requested, and when they arrive. */
  async during<Bytes extends Uint8Array>(number: number, read: Promise<Bytes>): Promise<Bytes> {
    if (this.#awaited++ === 0) this.#awaitedSinceMs = performance.now();
    this.#report();
    let bytes: Bytes;
    try {
      bytes = await read;
    } finally {
      const nowMs = performance.now();
      this.#awaitedMs += nowMs - this.#awaitedSinceMs;
      this.#awaitedSinceMs = nowMs;
      this.#awaited--;
    }
    this.#fetchedBytes += bytes.length;
    if (!this.#arrived.has(number)) this.#frameBytes += bytes.length;
    this.#arrived.add(number);
    this.#report();
    return bytes;
  }

  #report(): void {
    const { headerBytes, totalBytes } = this.#sizes;
    this.#onProgress?.({
      phase: 'read',
      loadedBytes: headerBytes + this.#frameBytes,
      totalBytes,
      splats: 0,
      bytesPerSecond: this.#awaitedMs > 0 ? (1000 * this.#fetchedBytes) / this.#awaitedMs : 0,
    });
  }
}
