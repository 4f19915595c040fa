import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { UpscaleParameters } from '../../data/layout/structs.ts';
import { readTexture } from '../../gpu/read-texture.ts';
import { readFloats } from '../../testing/gpu-textures.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { upscale as upscaleReference } from './compose.reference.ts';
import { upscale } from './compose.ts';

const FORMAT = 'rgba32float';

const gpu = testGpu();

describe('upscale', () => {
  for (const [from, to] of [
    [
      [16, 9],
      [64, 36],
    ],
    [
      [7, 5],
      [13, 11],
    ],
    [
      [1, 1],
      [5, 3],
    ],
    [
      [5, 1],
      [6, 4],
    ],
    [
      [8, 8],
      [8, 8],
    ],
  ]) {
    gpuTest(`${from.join('×')} to ${to.join('×')} px, with depths`, async () => {
      const stage = upscale(FORMAT, true);
      await gpu.pipelines.prepare([stage]);
      const random = seededRandom(51);
      const size = (px: readonly number[]) => ({ widthPx: px[0], heightPx: px[1] });
      const layers = [1, 1000].map((largest) =>
        Float32Array.from({ length: 4 * from[0] * from[1] }, () => largest * random()),
      );
      const [layer, depthLayer] = layers.map((values) => {
        const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST;
        const texture = gpu.device.createTexture({ size: from, format: FORMAT, usage });
        gpu.device.queue.writeTexture({ texture }, values, { bytesPerRow: 16 * from[0] }, from);
        return texture.createView();
      });
      const parameters = UpscaleParameters.pack({ layerPerPx: [from[0] / to[0], from[1] / to[1]] });
      const [image, depthImage] = ([FORMAT, 'r32float'] as const).map((format) =>
        gpu.device.createTexture({
          size: to,
          format,
          usage: GPUTextureUsage.STORAGE_BINDING | GPUTextureUsage.COPY_SRC,
        }),
      );
      const encoder = gpu.device.createCommandEncoder();
      const pass = encoder.beginComputePass();
      pass.setPipeline(gpu.pipelines.compute(stage)!);
      const bindings = {
        parameters: gpu.uniform(parameters),
        layer,
        image: image.createView(),
        depthLayer,
        depthImage: depthImage.createView(),
      };
      pass.setBindGroup(0, gpu.pipelines.bindGroup(stage, bindings));
      const tiles = to.map((px) => Math.ceil(px / SHADER_CONSTANTS.IMAGE_TILE_PX));
      pass.dispatchWorkgroups(tiles[0], tiles[1]);
      pass.end();
      gpu.device.queue.submit([encoder.finish()]);
      const written = [(await readTexture(gpu.device, image)).data, await readFloats(gpu.device, depthImage)];
      for (const [i, values] of written.entries()) {
        const expected = upscaleReference(layers[i], size(from), size(to));
        // A place errs by some roundings of up to 16 px, and its value by that share of its
        // neighbours' difference.
        const bound = 64 * 16 * 2 ** -24 * [1, 1000][i];
        // Of depths, one value of four is written.
        const step = expected.length / values.length;
        for (const [at, value] of values.entries())
          expect(Math.abs(value - expected[step * at]), `value ${at}`).toBeLessThanOrEqual(bound);
      }
    });
  }
});
