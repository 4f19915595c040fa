import { roundUp } from '../../data/layout/gpu-struct.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings, Pipelines, StageDefinition } from '../../gpu/pipelines.ts';
import { dispatchSize } from '../../stages/dispatch.ts';

/**
 * Stride of parameters: larger than any struct, and a multiple of every
 * `minUniformBufferOffsetAlignment`.
 */
const SLICE_BYTES = 512;

/** The services of an engine that dispatches need. */
export interface DispatchContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
  readonly dispatchRow: number;
}

interface Dispatch {
  readonly stage: StageDefinition;
  readonly parameters: ArrayBuffer;
  readonly bindings: Bindings;
  readonly workgroups: number;
}

/** Successive dispatches of compute stages. Their parameters share one buffer. */
export class Dispatches {
  readonly #context: DispatchContext;
  readonly #list: (Dispatch | ((pass: GPUComputePassEncoder) => void))[] = [];

  constructor(context: DispatchContext) {
    this.#context = context;
  }

  /** Adds a dispatch of a compiled stage whose binding `parameters` holds `parameters`. */
  add(stage: StageDefinition, parameters: ArrayBuffer, bindings: Bindings, workgroups: number): void {
    if (workgroups > 0) this.#list.push({ stage, parameters, bindings, workgroups });
  }

  /** Adds dispatches that the caller records itself. */
  call(record: (pass: GPUComputePassEncoder) => void): void {
    this.#list.push(record);
  }

  /** Submits all dispatches in one pass, after the commands that `begin` records. */
  submit(label: string, begin?: (encoder: GPUCommandEncoder) => void): void {
    const { device, pipelines, memory, dispatchRow } = this.#context;
    const bytes = SLICE_BYTES * this.#list.length;
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    const buffer = memory.createBuffer(`${label} parameters`, bytes, usage);
    const contents = new Uint8Array(bytes);
    const encoder = device.createCommandEncoder({ label });
    begin?.(encoder);
    const pass = encoder.beginComputePass({ label });
    for (const [i, each] of this.#list.entries()) {
      if (typeof each === 'function') {
        each(pass);
        continue;
      }
      const { stage, parameters, bindings, workgroups } = each;
      const offset = i * SLICE_BYTES;
      contents.set(new Uint8Array(parameters), offset);
      const slice = { buffer, offset, size: roundUp(parameters.byteLength, 16) };
      pass.setPipeline(pipelines.compute(stage)!);
      pass.setBindGroup(0, pipelines.bindGroup(stage, { ...bindings, parameters: slice }));
      pass.dispatchWorkgroups(...dispatchSize(workgroups, dispatchRow));
    }
    pass.end();
    device.queue.writeBuffer(buffer, 0, contents);
    device.queue.submit([encoder.finish()]);
    memory.destroy(buffer);
  }
}
