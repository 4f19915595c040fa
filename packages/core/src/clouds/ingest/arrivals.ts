import { GpuLimitError } from '../../data/errors.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { Chunk } from '../../data/layout/structs.ts';
import { callListener } from '../../data/listeners.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { type Bounds, movedBounds, robustBounds } from '../../data/packing/packed-cloud.ts';
import { nextTask } from '../../data/turns.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import { ingestGather } from '../../stages/gather/gather.ts';
import { CloudPlanes, type MadePlanes, type Plane } from '../cloud-planes.ts';
import { type CloudContents, SplatCloud } from '../splat-cloud.ts';
import type { DispatchContext } from './dispatches.ts';
import { type RowFacts, readRowFacts } from './row-facts.ts';
import { sampleCentres } from './sample-centres.ts';

/** Planes of a file whose rows are arriving, in file order, with a slot per row. */
export interface ArrivingPlanes extends Omit<MadePlanes, 'chunks'> {
  /** One buffer per page, for copies of the bounds of its chunks. */
  readonly chunks: Plane;
  /** Bounds of the arrived rows' chunks, over all pages. */
  readonly arrivedChunks: GPUBuffer;
  /** Buffer of statistics that ingest-rows updates. */
  readonly facts: GPUBuffer;
  /** Origin that the rows' positions are relative to, in scene space. */
  readonly origin: Vec3;
}

/** Growth in rows between two previews, so that no load shows more than a few dozen. */
const GROWTH = 1.25;
/**
 * Least time between two previews, in milliseconds. Frames delay the rows behind them. Nine
 * previews of a million splats doubled the loading time on an H200 at 26 ms a frame.
 */
const PAUSE_MS = 250;
/**
 * Most visible splats in a preview. Frames take more memory per splat than sorting the file does,
 * and all of the file may be in sight. This limit keeps the peak of a load close to the memory of
 * the loaded cloud.
 */
const MOST_VISIBLE = 3 << 18;

/** The previews of one load, one at a time: of the arrived rows of a file, at last of the whole cloud. */
export class Arrivals {
  readonly #context: DispatchContext;
  readonly #planes: ArrivingPlanes;
  readonly #name: string;
  readonly #onPreview: (preview: SplatCloud) => void;
  /** The current preview; null before the first. */
  #shown: SplatCloud | null = null;
  #release = () => {};
  /** Submitted rows. */
  #rows = 0;
  #leastRows = 1;
  #earliestMs = 0;
  #isReading = false;
  #isOver = false;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #failure: { readonly error: unknown } | null = null;

  constructor(
    context: DispatchContext,
    planes: ArrivingPlanes,
    name: string,
    onPreview: (preview: SplatCloud) => void,
  ) {
    this.#context = context;
    this.#planes = planes;
    this.#name = name;
    this.#onPreview = onPreview;
  }

  /** Reports that the first `rows` rows have been submitted. @throws errors of earlier previews. */
  add(rows: number): void {
    this.#rows = rows;
    this.#check();
    this.#next();
  }

  /** Shows no more arrived rows. @throws errors of earlier previews. */
  stop(): void {
    this.#isOver = true;
    clearTimeout(this.#timer);
    this.#check();
  }

  /** Makes frames keep their image until the next preview. */
  hold(): void {
    const next = new Promise<void>((resolve) => {
      this.#release = resolve;
    });
    this.#shown?.holdImage(next);
  }

  /** Replaces the preview, at last by one of the whole cloud. The caller keeps ownership of the planes. */
  show(planes: CloudPlanes, contents: CloudContents, visibleLimit?: number): SplatCloud {
    const before = this.#shown;
    const options = { name: this.#name, isPreview: true, visibleLimit };
    this.#shown = new SplatCloud(this.#context.device, planes, contents, options);
    callListener(this.#onPreview, this.#shown);
    before?.destroy();
    this.#release();
    return this.#shown;
  }

  /** Ends the previews, the current one too. */
  end(): void {
    this.#isOver = true;
    clearTimeout(this.#timer);
    this.#shown?.destroy();
    this.#release();
  }

  #check(): void {
    if (this.#failure) throw this.#failure.error;
  }

  /** Shows a preview now, or after the pause: the next rows may take long to arrive. */
  #next(): void {
    if (this.#isReading || this.#isOver || this.#failure || this.#rows < this.#leastRows) return;
    clearTimeout(this.#timer);
    const waitMs = this.#earliestMs - performance.now();
    if (waitMs > 0) {
      this.#timer = setTimeout(() => this.#next(), waitMs);
      return;
    }
    this.#isReading = true;
    this.#read()
      .catch((error: unknown) => {
        // Errors after the end are ignored, and so is a preview that exceeds memory.
        if (!this.#isOver && !(error instanceof GpuLimitError)) this.#failure = { error };
      })
      .finally(() => {
        this.#isReading = false;
        this.#next();
      });
  }

  async #read(): Promise<void> {
    const { device, pipelines } = this.#context;
    const { facts, chunks, arrivedChunks, origin, ...made } = this.#planes;
    await pipelines.prepare([ingestGather]);
    if (this.#isOver) return;
    const count = this.#rows;
    this.#leastRows = GROWTH * count;
    this.#earliestMs = performance.now() + PAUSE_MS;
    const ranges = made.ranges
      .filter(({ start }) => start < count)
      .map(({ start, end }) => ({ start, end: Math.min(end, count) }));
    const pages = (plane: Plane) => plane.slice(0, ranges.length);
    const planes = {
      ...made,
      ranges,
      chunks: pages(chunks),
      geometry: pages(made.geometry),
      harmonics: pages(made.harmonics),
    };
    const read = () => {
      this.#copyChunks(planes);
      const reading = Promise.all([
        readWords(device, facts),
        sampleCentres(this.#context, { ...planes, count }),
        readWords(device, arrivedChunks, (Chunk.bytes / 4) * chunkCountOf(count)),
      ]);
      // Awaited only if the allocation succeeded.
      reading.catch(() => {});
      return reading;
    };
    const { result, checked } = this.#context.memory.guard('A preview', '', read);
    await checked;
    const [words, centres, chunkWords] = await result;
    await nextTask();
    if (this.#isOver) return;
    const found = readRowFacts(words, { count, shDegree: planes.shDegree });
    if (found.count === 0) return;
    const { geometryPrecision, shPrecision } = planes;
    const contents = {
      count,
      origin,
      bounds: movedBounds(found, origin),
      robustBounds: robustCentres(centres, found, origin),
      dropped: found.dropped,
      fileIndices: new Uint32Array(0),
      facts: found.facts,
      chunks: chunkWords.buffer,
      precision: { geometryPrecision, shPrecision },
    };
    const shown = new CloudPlanes(this.#context.memory, 'arrived', planes);
    this.show(shown, contents, MOST_VISIBLE);
  }

  #copyChunks({ ranges, chunks }: Pick<MadePlanes, 'ranges' | 'chunks'>): void {
    const { device } = this.#context;
    const encoder = device.createCommandEncoder({ label: 'ingest arrived chunks' });
    for (const [page, { start, end }] of ranges.entries()) {
      const from = Chunk.bytes * (start / CHUNK_SPLATS);
      const bytes = Chunk.bytes * chunkCountOf(end - start);
      encoder.copyBufferToBuffer(this.#planes.arrivedChunks, from, chunks[page], 0, bytes);
    }
    device.queue.submit([encoder.finish()]);
  }
}

/** Robust bounds of sampled slots, in scene space. @param centres relative to `origin`. */
function robustCentres(centres: readonly Float32Array[], { min, max }: RowFacts, origin: Vec3): Bounds {
  // Slots of dropped rows are 0, which may be far from all splats.
  const inside = centres.map(({ length }) => new Float32Array(length));
  const [x, y, z] = centres;
  let count = 0;
  // In one pass, because this runs on the main thread during loading.
  for (let i = 0; i < x.length; i++) {
    if (!(x[i] >= min[0] && x[i] <= max[0] && y[i] >= min[1] && y[i] <= max[1])) continue;
    if (!(z[i] >= min[2] && z[i] <= max[2])) continue;
    for (let axis = 0; axis < 3; axis++) inside[axis][count] = centres[axis][i];
    count++;
  }
  if (count === 0) return movedBounds({ min, max }, origin);
  return robustBounds(
    inside.map((values) => values.subarray(0, count)),
    origin,
  );
}
