import type { SizePx } from '../data/accuracy/accuracy.ts';
import { roundUp } from '../data/layout/gpu-struct.ts';
import type { Bindings, Pipelines, RenderState, StageDefinition } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import type { HostDepths } from '../stages/compose/compose.reference.ts';

/** A texture of RGBA in float32 for shaders to load, 4 values per pixel. */
export function colorTexture(
  device: GPUDevice,
  values: ArrayLike<number>,
  { widthPx, heightPx }: SizePx,
): GPUTexture {
  const texture = device.createTexture({
    size: [widthPx, heightPx],
    format: 'rgba32float',
    usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
  });
  const data = Float32Array.from(values);
  device.queue.writeTexture({ texture }, data, { bytesPerRow: 16 * widthPx }, [widthPx, heightPx]);
  return texture;
}

/** A depth texture with these values, 0…1, in every sample: drawn, as depths cannot be copied. */
export function depthTexture(
  device: GPUDevice,
  { widthPx, heightPx, samples, values }: HostDepths,
): GPUTexture {
  const texture = device.createTexture({
    size: [widthPx, heightPx],
    format: 'depth32float',
    sampleCount: samples,
    usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING,
  });
  const depths = device.createBuffer({
    size: 4 * values.length,
    usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST,
  });
  device.queue.writeBuffer(depths, 0, Float32Array.from(values));
  const module = device.createShaderModule({
    code: `@group(0) @binding(0) var<storage, read> depths: array<f32>;
      @vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
      }
      @fragment fn paint(
        @builtin(position) position: vec4f,
        @builtin(sample_index) i: u32,
      ) -> @builtin(frag_depth) f32 {
        let pixel = u32(position.y) * ${widthPx}u + u32(position.x);
        return depths[pixel * ${samples}u + i];
      }`,
  });
  const pipeline = device.createRenderPipeline({
    layout: 'auto',
    vertex: { module },
    fragment: { module, targets: [] },
    multisample: { count: samples },
    depthStencil: { format: texture.format, depthCompare: 'always', depthWriteEnabled: true },
  });
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginRenderPass({
    colorAttachments: [],
    depthStencilAttachment: {
      view: texture.createView(),
      depthLoadOp: 'clear',
      depthStoreOp: 'store',
      depthClearValue: 0,
    },
  });
  pass.setPipeline(pipeline);
  const entries = [{ binding: 0, resource: { buffer: depths } }];
  pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
  pass.draw(3);
  pass.end();
  device.queue.submit([encoder.finish()]);
  return texture;
}

/** Compiles a stage that covers its targets with one triangle and draws it once. */
export async function drawStage(
  device: GPUDevice,
  pipelines: Pipelines,
  [stage, state]: readonly [StageDefinition, RenderState],
  bindings: Bindings,
  attachments: GPURenderPassDescriptor,
): Promise<void> {
  await pipelines.prepare([[stage, state]]);
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginRenderPass(attachments);
  pass.setPipeline(pipelines.render(stage, state)!);
  pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
  pass.draw(3);
  pass.end();
  device.queue.submit([encoder.finish()]);
}

/** Values of a texture with one float32 per pixel, top row first. */
export async function readFloats(device: GPUDevice, texture: GPUTexture): Promise<Float32Array> {
  const { width, height } = texture;
  const bytesPerRow = roundUp(4 * width, 256);
  const buffer = device.createBuffer({
    size: bytesPerRow * height,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC,
  });
  const encoder = device.createCommandEncoder();
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [width, height]);
  device.queue.submit([encoder.finish()]);
  const rows = new Float32Array((await readWords(device, buffer)).buffer);
  buffer.destroy();
  const rowLength = bytesPerRow / 4;
  return Float32Array.from(
    { length: width * height },
    (_, i) => rows[Math.floor(i / width) * rowLength + (i % width)],
  );
}
