import { roundUp } from '../../data/layout/gpu-struct.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../../gpu/pipelines.ts';
import { dispatchSize } from '../../gpu/stages/dispatch.ts';

/** Stride of parameters: room for all, and a multiple of any `minUniformBufferOffsetAlignment`. */
const SLICE_BYTES = 512;

interface Dispatch {
  readonly stage: StageDefinition;
  readonly parameters: ArrayBuffer;
  readonly bindings: Readonly<Record<string, GPUBuffer | GPUBufferBinding>>;
  readonly workgroups: number;
}

/** Successive dispatches of compute stages, whose parameters lie in one buffer. */
export class Dispatches {
  readonly #device: GPUDevice;
  readonly #pipelines: Pipelines;
  readonly #memory: GpuMemory;
  readonly #dispatchRow: number;
  readonly #list: (Dispatch | ((pass: GPUComputePassEncoder) => void))[] = [];

  constructor(device: GPUDevice, pipelines: Pipelines, memory: GpuMemory, dispatchRow: number) {
    this.#device = device;
    this.#pipelines = pipelines;
    this.#memory = memory;
    this.#dispatchRow = dispatchRow;
  }

  /** Adds a dispatch of a compiled stage whose binding `parameters` holds `parameters`. */
  add(
    stage: StageDefinition,
    parameters: ArrayBuffer,
    bindings: Dispatch['bindings'],
    workgroups: number,
  ): void {
    if (workgroups > 0) this.#list.push({ stage, parameters, bindings, workgroups });
  }

  /** Adds dispatches that `record` records. */
  call(record: (pass: GPUComputePassEncoder) => void): void {
    this.#list.push(record);
  }

  /** Records all in one pass. @returns the buffer of parameters, to be freed after the submit. */
  record(encoder: GPUCommandEncoder, label: string): GPUBuffer {
    const bytes = SLICE_BYTES * this.#list.length;
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    const buffer = this.#memory.createBuffer(`${label} parameters`, bytes, usage);
    const contents = new Uint8Array(bytes);
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
      pass.setPipeline(this.#pipelines.compute(stage)!);
      pass.setBindGroup(0, this.#pipelines.bindGroup(stage, { ...bindings, parameters: slice }));
      pass.dispatchWorkgroups(...dispatchSize(workgroups, this.#dispatchRow));
    }
    pass.end();
    this.#device.queue.writeBuffer(buffer, 0, contents);
    return buffer;
  }
}
