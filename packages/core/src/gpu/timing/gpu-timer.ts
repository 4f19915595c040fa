import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { CutPlan, shiftedError } from '../../data/layout/level-structs.ts';
import { TilePlan } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../gpu-memory.ts';
import {
  type FrameStatistics,
  type StageTimings,
  TIMED_PASSES,
  type TimedPass,
  wallClockTimings,
} from './frame-statistics.ts';

/** Read-backs that may be pending at once; if none is free, a frame goes unmeasured. */
const RING_SIZE = 4;

const TIMESTAMP_BYTES = 8 * 2 * TIMED_PASSES.length;
const COUNTS_BYTES = 8;
const TILES_AT = TIMESTAMP_BYTES + COUNTS_BYTES;
const CUT_AT = TILES_AT + TilePlan.bytes;
/**
 * Timestamps, then the numbers of visible chunks and splats, a word each, then one `TilePlan` and
 * one `CutPlan`.
 */
const READBACK_BYTES = CUT_AT + CutPlan.bytes;

/** Buffers with the counts of a frame. */
export interface FrameCounts {
  readonly slotCount: GPUBuffer;
  readonly visibleCount: GPUBuffer;
  /** One `TilePlan`; only for shapes with tiles. */
  readonly tilePlan?: GPUBuffer;
  /** One `CutPlan`; only for frames with a budget. */
  readonly cutPlan?: GPUBuffer;
}

/** Facts of a frame that the CPU has without a read-back. */
interface KnownFrame {
  /** Number of the frame, from 1. */
  readonly frame: number;
  readonly loadedSplats: number;
  /** Error of the frame's cuts before a budget shifts it, in pixels; null without a cut. */
  readonly cutErrorPx: number | null;
}

/** A query set per device, checked to work: with it, the next timer can time its first frame. */
const SPARE = new WeakMap<GPUDevice, GPUQuerySet>();

/** Measures frames without waits for the GPU: a ring of buffers is read some frames later. */
export class GpuTimer {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  readonly #hasTimestamps: boolean;
  /** Null without timestamps, and until the set is checked to work. */
  #querySet: GPUQuerySet | null = null;
  /** Query set of the frame that is being recorded; null if the frame is not timed. */
  #recorded: GPUQuerySet | null = null;
  #resolved: GPUBuffer | null = null;
  /** Made with the first frame, whose memory is checked. */
  #ring: readonly GPUBuffer[] | null = null;
  #free: GPUBuffer[] = [];
  #measuring: GPUBuffer | null = null;
  #passes = new Set<TimedPass>();
  #hasPairs = false;
  #hasBudget = false;
  #isDestroyed = false;

  constructor(device: GPUDevice, memory: GpuMemory) {
    this.#memory = memory;
    this.#queue = device.queue;
    this.#hasTimestamps = device.features.has('timestamp-query');
    if (!this.#hasTimestamps) return;
    this.#querySet = SPARE.get(device) ?? null;
    SPARE.delete(device);
    void this.#makeQuerySet(device);
  }

  /** Call first in a frame. */
  begin(): void {
    this.#ring ??= this.#makeRing();
    // Reuse the buffer of a frame that was begun and never drawn.
    this.#measuring ??= this.#free.pop() ?? null;
    this.#passes = new Set();
    this.#recorded = this.#querySet;
  }

  /** Returns `timestampWrites` of a pass; undefined if this frame or device is not timed. */
  writes(pass: TimedPass): GPUComputePassTimestampWrites | undefined {
    this.#passes.add(pass);
    if (!this.#recorded || !this.#measuring) return undefined;
    const first = 2 * TIMED_PASSES.indexOf(pass);
    return { querySet: this.#recorded, beginningOfPassWriteIndex: first, endOfPassWriteIndex: first + 1 };
  }

  /** Call after the last pass, before the encoder is finished. */
  record(encoder: GPUCommandEncoder, counts: FrameCounts): void {
    const target = this.#measuring;
    if (!target) return;
    if (this.#recorded && this.#resolved) {
      encoder.resolveQuerySet(this.#recorded, 0, 2 * TIMED_PASSES.length, this.#resolved, 0);
      encoder.copyBufferToBuffer(this.#resolved, 0, target, 0, TIMESTAMP_BYTES);
    }
    encoder.copyBufferToBuffer(counts.slotCount, 0, target, TIMESTAMP_BYTES, 4);
    encoder.copyBufferToBuffer(counts.visibleCount, 0, target, TIMESTAMP_BYTES + 4, 4);
    const { tilePlan, cutPlan } = counts;
    this.#hasPairs = tilePlan !== undefined;
    if (tilePlan) encoder.copyBufferToBuffer(tilePlan, 0, target, TILES_AT, TilePlan.bytes);
    this.#hasBudget = cutPlan !== undefined;
    if (cutPlan) encoder.copyBufferToBuffer(cutPlan, 0, target, CUT_AT, CutPlan.bytes);
  }

  /**
   * Call after submitting. Resolves when the frame is done; null if it was not measured.
   *
   * @param submittedMs `performance.now()` when the frame's first submission was made.
   */
  async read(
    { frame, loadedSplats, cutErrorPx }: KnownFrame,
    submittedMs = performance.now(),
  ): Promise<FrameStatistics | null> {
    const buffer = this.#measuring;
    const passes = this.#passes;
    const hasPairs = this.#hasPairs;
    const hasBudget = this.#hasBudget;
    const isTimed = this.#recorded !== null;
    this.#measuring = null;
    // The view may be destroyed between its submission and this call.
    if (!buffer || this.#isDestroyed) return null;
    try {
      const mapped = this.#memory.map(buffer, GPUMapMode.READ);
      await this.#queue.onSubmittedWorkDone();
      const wallClockMs = performance.now() - submittedMs;
      await mapped;
      if (this.#isDestroyed) return null;
      const contents = buffer.getMappedRange().slice(0);
      buffer.unmap();
      const [slots, visibleSplats] = new Uint32Array(contents, TIMESTAMP_BYTES);
      const tilePlan = new Uint32Array(contents, TILES_AT);
      const neededPairs = tilePlan[TilePlan.offsets.neededPairs / 4];
      const fits = tilePlan[TilePlan.offsets.fits / 4] === 1;
      const shift = new Uint32Array(contents, CUT_AT)[CutPlan.offsets.shift / 4];
      const candidateSplats = Math.min(loadedSplats, slots * CHUNK_SPLATS);
      const spanMs = isTimed
        ? spansOf(new BigUint64Array(contents, 0, 2 * TIMED_PASSES.length), passes)
        : null;
      const timing = spanMs ? timingsOf(spanMs, passes, wallClockMs) : wallClockTimings(wallClockMs);
      const quadsSampleMs = spanMs && passes.has('quads-sample') ? spanMs('quads-sample') : null;
      return {
        frame,
        loadedSplats,
        candidateSplats,
        visibleSplats,
        cutErrorPx: cutErrorPx !== null && hasBudget ? shiftedError(cutErrorPx, shift) : cutErrorPx,
        rasterizer: hasPairs && fits ? 'tiles' : 'quads',
        tilePairs: hasPairs ? neededPairs : null,
        quadsSampleMs,
        timing,
      };
    } catch (error) {
      // Destroyed or lost while the read-back was pending: the statistics are not needed any more.
      if (this.#isDestroyed || buffer.mapState === 'unmapped') return null;
      throw error;
    } finally {
      if (!this.#isDestroyed) this.#free.push(buffer);
    }
  }

  destroy(): void {
    this.#isDestroyed = true;
    for (const buffer of this.#ring ?? []) this.#memory.destroy(buffer);
    if (this.#resolved) this.#memory.destroy(this.#resolved);
    this.#querySet?.destroy();
  }

  /**
   * Makes a query set and a spare one, and keeps them only if they work. Metal has 32 for all pages
   * together (https://github.com/gpuweb/gpuweb/issues/5261), and passes that use a failed one are
   * not run.
   */
  async #makeQuerySet(device: GPUDevice): Promise<void> {
    device.pushErrorScope('validation');
    const querySet = device.createQuerySet({ type: 'timestamp', count: 2 * TIMED_PASSES.length });
    // A lost device answers no more, and times nothing.
    const error = await device.popErrorScope().catch((reason: Error) => reason);
    if (error || this.#isDestroyed || (this.#querySet && SPARE.has(device))) querySet.destroy();
    else if (this.#querySet) SPARE.set(device, querySet);
    else {
      this.#querySet = querySet;
      await this.#makeQuerySet(device);
    }
  }

  #makeRing(): readonly GPUBuffer[] {
    const { QUERY_RESOLVE, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
    const memory = this.#memory;
    if (this.#hasTimestamps)
      this.#resolved = memory.createBuffer('timestamps', TIMESTAMP_BYTES, QUERY_RESOLVE | COPY_SRC);
    const ring: GPUBuffer[] = [];
    // Objects are listed as made, to be freed if one fails.
    this.#ring = ring;
    for (let i = 0; i < RING_SIZE; i++)
      ring.push(memory.createBuffer(`statistics ${i}`, READBACK_BYTES, MAP_READ | COPY_DST));
    this.#free = [...ring];
    return ring;
  }
}

/** Returns the time from the first start to the last end of some passes, ms; 0 if none ran. */
type SpanMs = (...candidates: TimedPass[]) => number;

/** @param passes passes that the frame ran: the queries of other passes are stale or unwritten. */
function spansOf(nanoseconds: BigUint64Array, passes: ReadonlySet<TimedPass>): SpanMs {
  return (...candidates) => {
    const indices = candidates.filter((pass) => passes.has(pass)).map((pass) => TIMED_PASSES.indexOf(pass));
    if (indices.length === 0) return 0;
    const span = nanoseconds[2 * indices[indices.length - 1] + 1] - nanoseconds[2 * indices[0]];
    // Some drivers write an end before its beginning, or nothing at all.
    return Math.max(0, Number(span) / 1e6);
  };
}

function timingsOf(spanMs: SpanMs, passes: ReadonlySet<TimedPass>, wallClockMs: number): StageTimings {
  return {
    source: 'gpu-timestamps',
    preprocessMs: spanMs('preprocess'),
    sortMs: spanMs('sort'),
    // Three spans: a host's work may follow the lists, and a sample of quads precede the tiles.
    rasterizeMs:
      spanMs('tile-lists') + spanMs('resolve-depth') + spanMs('tiles', 'rasterize', 'upscale', 'composite'),
    totalMs: spanMs(...TIMED_PASSES),
    wallClockMs,
    passMs: Object.fromEntries([...passes].map((pass) => [pass, spanMs(pass)])),
  };
}
