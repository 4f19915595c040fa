import { WebSplatterError } from '../../data/errors.ts';
import type { GpuMemory } from '../gpu-memory.ts';
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

interface ProfiledPass {
  readonly part: string;
  stage: string;
  dispatches: number;
}

/**
 * Splits a frame into passes of its own for each stage, and times each by itself. The frame's work
 * and image stay the same, but the GPU pauses between passes: their times add up to more than the
 * undivided frame takes.
 *
 * Wraps the command encoder that a frame is recorded into: recording is the same code with and
 * without it, and frames without a profile cost nothing more. Needs the feature `timestamp-query`.
 */
export class FrameProfile {
  readonly #memory: GpuMemory;
  readonly #querySet: GPUQuerySet;
  readonly #resolved: GPUBuffer;
  readonly #readback: GPUBuffer;
  #passes: ProfiledPass[] = [];

  constructor(memory: GpuMemory) {
    this.#memory = memory;
    const { COPY_SRC, COPY_DST, MAP_READ, QUERY_RESOLVE } = GPUBufferUsage;
    const bytes = QUERY_BYTES * 2 * MOST_PASSES;
    this.#querySet = memory.device.createQuerySet({ type: 'timestamp', count: 2 * MOST_PASSES });
    this.#resolved = memory.createBuffer('profile timestamps', bytes, QUERY_RESOLVE | COPY_SRC);
    this.#readback = memory.createBuffer('profile', bytes, MAP_READ | COPY_DST);
  }

  /** Returns an encoder into `encoder` that splits passes. Finish it before the next. */
  split(encoder: GPUCommandEncoder): GPUCommandEncoder {
    this.#passes = [];
    return withMethods(encoder, {
      beginComputePass: (descriptor) => this.#splitCompute(encoder, descriptor?.label ?? ''),
      beginRenderPass: (descriptor) => this.#timeRender(encoder, descriptor),
      finish: (descriptor) => {
        const count = 2 * this.#passes.length;
        if (count > 0) {
          encoder.resolveQuerySet(this.#querySet, 0, count, this.#resolved, 0);
          encoder.copyBufferToBuffer(this.#resolved, 0, this.#readback, 0, QUERY_BYTES * count);
        }
        return encoder.finish(descriptor);
      },
    });
  }

  /** Returns times of the last frame split and submitted, by stage in the order of first passes. */
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

  /** A pass that ends and begins anew wherever the pipeline changes. */
  #splitCompute(encoder: GPUCommandEncoder, part: string): GPUComputePassEncoder {
    let pass: GPUComputePassEncoder | null = null;
    let current: GPUComputePipeline | null = null;
    const counted = () => {
      this.#passes.at(-1)!.dispatches++;
      return pass!;
    };
    // All methods that parts of a frame call. A missing one fails at the first call.
    const split: Pick<
      GPUComputePassEncoder,
      'setPipeline' | 'setBindGroup' | 'dispatchWorkgroups' | 'dispatchWorkgroupsIndirect' | 'end'
    > = {
      setPipeline: (pipeline) => {
        if (pipeline === current) return;
        current = pipeline;
        pass?.end();
        const timestampWrites = this.#begin(part, stageNameOf(pipeline));
        pass = encoder.beginComputePass({ label: `${part}: ${pipeline.label}`, timestampWrites });
        pass.setPipeline(pipeline);
      },
      setBindGroup: (index: number, group: GPUBindGroup | null | undefined) =>
        pass!.setBindGroup(index, group),
      dispatchWorkgroups: (...size) => counted().dispatchWorkgroups(...size),
      dispatchWorkgroupsIndirect: (...where) => counted().dispatchWorkgroupsIndirect(...where),
      end: () => pass?.end(),
    };
    return split as GPUComputePassEncoder;
  }

  /** Render passes run one stage each. */
  #timeRender(encoder: GPUCommandEncoder, descriptor: GPURenderPassDescriptor): GPURenderPassEncoder {
    const timestampWrites = this.#begin(descriptor.label ?? '', '');
    const timed = this.#passes.at(-1)!;
    const pass = encoder.beginRenderPass({ ...descriptor, timestampWrites });
    return withMethods(pass, {
      setPipeline: (pipeline) => {
        timed.stage = stageNameOf(pipeline);
        pass.setPipeline(pipeline);
      },
      draw: (...rest) => {
        timed.dispatches++;
        pass.draw(...rest);
      },
      drawIndirect: (...rest) => {
        timed.dispatches++;
        pass.drawIndirect(...rest);
      },
    });
  }

  #begin(part: string, stage: string): GPUComputePassTimestampWrites {
    const first = 2 * this.#passes.length;
    if (this.#passes.push({ part, stage, dispatches: 0 }) > MOST_PASSES) {
      throw new WebSplatterError(
        'gpu-error',
        `A frame of more than ${MOST_PASSES} passes cannot be profiled.`,
      );
    }
    return { querySet: this.#querySet, beginningOfPassWriteIndex: first, endOfPassWriteIndex: first + 1 };
  }
}

/** Returns `target` with some methods replaced. Others act on `target`, as WebGPU's must. */
function withMethods<Target extends object>(target: Target, replaced: Partial<Target>): Target {
  return new Proxy(target, {
    get(_, name) {
      const found = Reflect.get(name in replaced ? replaced : target, name);
      return typeof found === 'function' ? found.bind(target) : found;
    },
  });
}
