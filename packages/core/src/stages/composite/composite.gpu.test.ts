import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CompositeParameters } from '../../data/layout/structs.ts';
import { readTexture } from '../../gpu/read-texture.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { composite as compositeReference } from './composite.reference.ts';
import { composite, compositeState } from './composite.ts';

const gpu = testGpu();

describe('composite', () => {
  for (const format of ['rgba32float', 'rgba8unorm'] as const) {
    gpuTest(`composites a layer over the background, into ${format}`, async () => {
      const state = compositeState(format);
      await gpu.pipelines.prepare([[composite, state]]);
      const [width, height] = [13, 7];
      const random = seededRandom(31);
      const alphas = Float32Array.from({ length: width * height }, (_, i) => [0, 1, random()][i % 3]);
      const layer = Float32Array.from({ length: 4 * width * height }, (_, i) =>
        i % 4 === 3 ? alphas[i >> 2] : random() * alphas[i >> 2],
      );
      const background = [0.2, 0.6, 1] as const;
      const source = gpu.device.createTexture({
        size: [width, height],
        format: 'rgba32float',
        usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
      });
      gpu.device.queue.writeTexture({ texture: source }, layer, { bytesPerRow: 16 * width }, [width, height]);
      const parameters = CompositeParameters.pack({ background });
      const target = gpu.device.createTexture({
        size: [width, height],
        format,
        usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
      });
      const encoder = gpu.device.createCommandEncoder();
      const pass = encoder.beginRenderPass({
        colorAttachments: [{ view: target.createView(), loadOp: 'clear', storeOp: 'store' }],
      });
      pass.setPipeline(gpu.pipelines.render(composite, state)!);
      const bindings = { parameters: gpu.uniform(parameters), layer: source.createView() };
      pass.setBindGroup(0, gpu.pipelines.bindGroup(composite, bindings));
      pass.draw(3);
      pass.end();
      gpu.device.queue.submit([encoder.finish()]);
      const { data } = await readTexture(gpu.device, target);
      const expected = compositeReference(layer, background);
      // Three roundings of numbers up to 1. Eight bits: half a step, to which WebGPU adds a tenth.
      const bound = format === 'rgba8unorm' ? 0.6 / 255 : 4 * 2 ** -24;
      for (const [i, value] of expected.entries()) {
        expect(Math.abs(data[i] - value), `value ${i}`).toBeLessThanOrEqual(bound);
      }
    });
  }
});
