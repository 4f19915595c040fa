import { shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll } from 'vitest';
import { type Bindings, Pipelines, type StageDefinition } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';

/** The device that the tests of a file share, with helpers that run one stage. */
export class TestGpu {
  device!: GPUDevice;
  pipelines!: Pipelines;

  /** A storage buffer holding `words`, at least `bytes` long, that can be read back. */
  storage(
    words: Uint32Array | Float32Array | readonly number[],
    bytes = 0,
    usage: GPUBufferUsageFlags = GPUBufferUsage.STORAGE,
  ): GPUBuffer {
    const data = ArrayBuffer.isView(words) ? words : Uint32Array.from(words);
    const size = Math.max(4, bytes, data.byteLength);
    const flags = usage | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
    const buffer = this.device.createBuffer({ size, usage: flags });
    this.device.queue.writeBuffer(buffer, 0, data as Uint32Array<ArrayBuffer>);
    return buffer;
  }

  /** A uniform buffer holding `contents`. */
  uniform(contents: ArrayBuffer): GPUBuffer {
    return this.storage(new Uint32Array(contents), 0, GPUBufferUsage.UNIFORM);
  }

  read(buffer: GPUBuffer) {
    return readWords(this.device, buffer);
  }

  /** Compiles one compute stage and runs it once. */
  async run(
    stage: StageDefinition,
    bindings: Bindings,
    workgroups: readonly [number, number, number],
    pipelines = this.pipelines,
  ): Promise<void> {
    await pipelines.prepare([stage]);
    const encoder = this.device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipelines.compute(stage)!);
    pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
    pass.dispatchWorkgroups(...workgroups);
    pass.end();
    this.device.queue.submit([encoder.finish()]);
  }
}

/** Lends the tests of the calling file a device. */
export function testGpu(lend: () => Promise<GPUDevice> = shareTestDevice): TestGpu {
  const gpu = new TestGpu();
  beforeAll(async () => {
    gpu.device = await lend();
    gpu.pipelines = new Pipelines(gpu.device);
  });
  return gpu;
}
