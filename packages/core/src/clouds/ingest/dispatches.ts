import { roundUp } from '../../data/layout/gpu-struct.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings, Pipelines, StageDefinition } from '../../gpu/pipelines.ts';
import { dispatchSize } from '../../stages/dispatch.ts';

/** Alignment of parameters: a multiple of every `minUniformBufferOffsetAlignment`. */
const ALIGNED_BYTES = 512;

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

/** Records dispatches. */
type Recorder = (pass: GPUComputePassEncoder) => void;

/** Successive dispatches of compute stages. Their parameters share one buffer. */
export class Dispatches {
  readonly #context: DispatchContext;
  readonly #list: (Dispatch | Recorder)[] = [];

  constructor(context: DispatchContext) {
    this.#context = context;
  }

  /** Adds a dispatch of a compiled stage whose binding `parameters` holds `parameters`. */
  add(stage: StageDefinition, parameters: ArrayBuffer, bindings: Bindings, workgroups: number): void {
    if (workgroups > 0) this.#list.push({ stage, parameters, bindings, workgroups });
  }

  /** Adds dispatches that the caller records itself. */
  call(record: Recorder): void {
    this.#list.push(record);
  }

  /** Submits all dispatches in one pass, after the commands that `begin` records. */
  submit(label: string, begin?: (encoder: GPUCommandEncoder) => void): void {
    const { device, pipelines, memory, dispatchRow } = this.#context;
    const bytes = this.#list.reduce((sum, each) => sum + alignedBytes(each), 0);
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    const buffer = memory.createBuffer(`${label} parameters`, bytes, usage);
    const contents = new Uint8Array(bytes);
    const encoder = device.createCommandEncoder({ label });
    begin?.(encoder);
    const pass = encoder.beginComputePass({ label });
    let end = 0;
    for (const each of this.#list) {
      const offset = end;
      end += alignedBytes(each);
      if (typeof each === 'function') {
        each(pass);
        continue;
      }
      const { stage, parameters, bindings, workgroups } = each;
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

/** Bytes for the parameters of a dispatch. Recorders get some too: Deno 2.9 ends at a write of no bytes. */
function alignedBytes(each: Dispatch | Recorder): number {
  return typeof each === 'function' ? ALIGNED_BYTES : roundUp(each.parameters.byteLength, ALIGNED_BYTES);
}
