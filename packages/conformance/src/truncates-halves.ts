/** Three quarters of the way from 1 to the next half: rounding gives the next, and truncation 1. */
const ADDED = 0.75 * 2 ** -10;
const ONE_AS_HALF = 0x3c00;

const SHADER = `
@vertex fn vertexMain(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
  return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
@fragment fn fragmentMain() -> @location(0) vec4f {
  return vec4f(${ADDED});
}`;

/**
 * Measures whether the device rounds towards zero when it blends in rgba16float; WebGPU lets it.
 * Sums of many layers then stall twice as early as where it rounds to the nearest.
 */
export async function truncatesHalves(device: GPUDevice): Promise<boolean> {
  const label = 'rounding of halves';
  const module = device.createShaderModule({ label, code: SHADER });
  const add = { srcFactor: 'one', dstFactor: 'one' } as const;
  const format = 'rgba16float';
  const pipeline = await device.createRenderPipelineAsync({
    label,
    layout: 'auto',
    vertex: { module },
    fragment: { module, targets: [{ format, blend: { color: add, alpha: add } }] },
  });
  const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC;
  const texture = device.createTexture({ label, size: [1, 1], format, usage });
  const read = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
  const buffer = device.createBuffer({ label, size: 8, usage: read });
  try {
    const encoder = device.createCommandEncoder({ label });
    const pass = encoder.beginRenderPass({
      label,
      colorAttachments: [
        { view: texture.createView(), loadOp: 'clear', clearValue: [1, 1, 1, 1], storeOp: 'store' },
      ],
    });
    pass.setPipeline(pipeline);
    pass.draw(3);
    pass.end();
    encoder.copyTextureToBuffer({ texture }, { buffer }, [1, 1]);
    device.queue.submit([encoder.finish()]);
    await buffer.mapAsync(GPUMapMode.READ);
    return new Uint16Array(buffer.getMappedRange())[0] === ONE_AS_HALF;
  } finally {
    texture.destroy();
    buffer.destroy();
  }
}
