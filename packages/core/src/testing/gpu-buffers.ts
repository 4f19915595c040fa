import type { Bindings, Pipelines, StageDefinition } from '../gpu/pipelines.ts';

/** A storage buffer holding `words`, at least `bytes` long, that can be read back. */
export function storageBuffer(
  device: GPUDevice,
  words: Uint32Array | Float32Array | readonly number[],
  bytes = 0,
  usage: GPUBufferUsageFlags = GPUBufferUsage.STORAGE,
): GPUBuffer {
  const data = ArrayBuffer.isView(words) ? words : Uint32Array.from(words);
  const size = Math.max(4, bytes, data.byteLength);
  const flags = usage | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
  const buffer = device.createBuffer({ size, usage: flags });
  device.queue.writeBuffer(buffer, 0, data as Uint32Array<ArrayBuffer>);
  return buffer;
}

/** A uniform buffer holding `contents`. */
export function uniformBuffer(device: GPUDevice, contents: ArrayBuffer): GPUBuffer {
  return storageBuffer(device, new Uint32Array(contents), 0, GPUBufferUsage.UNIFORM);
}

/** Compiles one compute stage and runs it once. */
export async function runStage(
  device: GPUDevice,
  pipelines: Pipelines,
  stage: StageDefinition,
  bindings: Bindings,
  workgroups: readonly [number, number, number],
): Promise<void> {
  await pipelines.prepare([stage]);
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  pass.setPipeline(pipelines.compute(stage)!);
  pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
  pass.dispatchWorkgroups(...workgroups);
  pass.end();
  device.queue.submit([encoder.finish()]);
}
