import { WebSplatterError } from '../../data/errors.ts';
import type { GpuMemory } from '../gpu-memory.ts';
import { type Dispatch, type FramePass, recordPass } from '../passes.ts';
import { stageNameOf } from '../pipelines.ts';

/** Time of one stage in one part of a frame. */
export interface PassTime {
  /** Label of the stage's pass in frames without a profile, e.g. `pre-process`. */
  readonly part: string;
  /** Name of the stage's WGSL file without extension, e.g. `cull-splats`. */
  readonly stage: string;
  /** Number of dispatches or draws. */
  readonly dispatches: number;
  /** GPU time of all of them, in milliseconds. */
  readonly elapsedMs: number;
}

/** Most passes of a frame, each with two queries: a query set holds no more. */
const MOST_PASSES = 2048;
const QUERY_BYTES = 8;

/**
 * Splits a frame into passes of its own for each stage, and times each by itself. The frame's work
 * and image stay the same, but the GPU pauses between passes: their times add up to more than the
 * undivided frame takes. Needs the feature `timestamp-query`.
 */
export class FrameProfile {
  readonly #memory: GpuMemory;
  readonly #querySet: GPUQuerySet;
  readonly #resolved: GPUBuffer;
  readonly #readback: GPUBuffer;
  #passes: Omit<PassTime, 'elapsedMs'>[] = [];

  constructor(memory: GpuMemory) {
    this.#memory = memory;
    const { COPY_SRC, COPY_DST, MAP_READ, QUERY_RESOLVE } = GPUBufferUsage;
    const bytes = QUERY_BYTES * 2 * MOST_PASSES;
    this.#querySet = memory.device.createQuerySet({ type: 'timestamp', count: 2 * MOST_PASSES });
    this.#resolved = memory.createBuffer('profile timestamps', bytes, QUERY_RESOLVE | COPY_SRC);
    this.#readback = memory.createBuffer('profile', bytes, MAP_READ | COPY_DST);
  }

  /** Call first in a frame. */
  begin(): void {
    this.#passes = [];
  }

  /** Records a pass of the frame as one pass for each run of dispatches of the same stage. */
  record(encoder: GPUCommandEncoder, pass: FramePass): void {
    if (!('dispatches' in pass)) {
      recordPass(encoder, pass, this.#writes(pass.label, pass.pipeline, pass.draws.length));
      return;
    }
    let run: Dispatch[] = [];
    for (const [i, dispatch] of pass.dispatches.entries()) {
      const { pipeline } = dispatch;
      run.push(dispatch);
      if (pass.dispatches[i + 1]?.pipeline === pipeline) continue;
      const split = { ...pass, label: `${pass.label}: ${pipeline.label}`, dispatches: run };
      recordPass(encoder, split, this.#writes(pass.label, pipeline, run.length));
      run = [];
    }
  }

  /** Call after the last pass of the frame. */
  end(encoder: GPUCommandEncoder): void {
    const count = 2 * this.#passes.length;
    if (count === 0) return;
    encoder.resolveQuerySet(this.#querySet, 0, count, this.#resolved, 0);
    encoder.copyBufferToBuffer(this.#resolved, 0, this.#readback, 0, QUERY_BYTES * count);
  }

  /** Returns times of the last frame that was submitted, by stage in the order of first passes. */
  async read(): Promise<PassTime[]> {
    const passes = this.#passes;
    await this.#memory.map(this.#readback, GPUMapMode.READ);
    const nanoseconds = new BigUint64Array(this.#readback.getMappedRange().slice(0));
    this.#readback.unmap();
    const times = new Map<string, PassTime>();
    for (const [index, { part, stage, dispatches }] of passes.entries()) {
      const key = `${part}/${stage}`;
      const before = times.get(key) ?? { part, stage, dispatches: 0, elapsedMs: 0 };
      // Some drivers write an end before its beginning.
      const elapsedMs = Math.max(0, Number(nanoseconds[2 * index + 1] - nanoseconds[2 * index]) / 1e6);
      times.set(key, {
        ...before,
        dispatches: before.dispatches + dispatches,
        elapsedMs: before.elapsedMs + elapsedMs,
      });
    }
    return [...times.values()];
  }

  destroy(): void {
    this.#querySet.destroy();
    this.#memory.destroy(this.#resolved);
    this.#memory.destroy(this.#readback);
  }

  #writes(part: string, pipeline: GPUObjectBase, dispatches: number): GPUComputePassTimestampWrites {
    const first = 2 * this.#passes.length;
    if (this.#passes.push({ part, stage: stageNameOf(pipeline), dispatches }) > MOST_PASSES) {
      throw new WebSplatterError(
        'gpu-error',
        `A frame of more than ${MOST_PASSES} passes cannot be profiled.`,
      );
    }
    return { querySet: this.#querySet, beginningOfPassWriteIndex: first, endOfPassWriteIndex: first + 1 };
  }
}
