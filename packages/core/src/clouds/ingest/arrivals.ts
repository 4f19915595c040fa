import { GpuLimitError } from '../../data/errors.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { Chunk } from '../../data/layout/structs.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { type Bounds, movedBounds, robustBounds } from '../../data/packing/packed-cloud.ts';
import { nextTask } from '../../data/turns.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import { ingestGather } from '../../stages/gather/gather.ts';
import { CloudPlanes, type MadePlanes, type Plane } from '../cloud-planes.ts';
import type { DispatchContext } from './dispatches.ts';
import type { LoadPreviews } from './load-previews.ts';
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

/** Shows previews of the arrived rows of a file. */
export class Arrivals {
  readonly #context: DispatchContext;
  readonly #planes: ArrivingPlanes;
  readonly #previews: LoadPreviews;
  /** Submitted rows. */
  #rows = 0;
  #leastRows = 1;
  #earliestMs = 0;
  #isReading = false;
  #isOver = false;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #failure: { readonly error: unknown } | null = null;

  constructor(context: DispatchContext, planes: ArrivingPlanes, previews: LoadPreviews) {
    this.#context = context;
    this.#planes = planes;
    this.#previews = previews;
  }

  /** Reports that the first `rows` rows have been submitted. @throws errors of earlier previews. */
  add(rows: number): void {
    this.#rows = rows;
    this.check();
    this.#show();
  }

  /** Ends the previews. */
  end(): void {
    this.#isOver = true;
    clearTimeout(this.#timer);
  }

  /** @throws errors of earlier previews. */
  check(): void {
    if (this.#failure) throw this.#failure.error;
  }

  /** Shows a preview now, or after the pause: the next rows may take long to arrive. */
  #show(): void {
    if (this.#isReading || this.#isOver || this.#failure || this.#rows < this.#leastRows) return;
    clearTimeout(this.#timer);
    const waitMs = this.#earliestMs - performance.now();
    if (waitMs > 0) {
      this.#timer = setTimeout(() => this.#show(), waitMs);
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
        this.#show();
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
    this.#previews.show(shown, contents, MOST_VISIBLE);
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
