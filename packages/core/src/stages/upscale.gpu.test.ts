import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { Pipelines } from '../gpu/pipelines.ts';
import { readTexture } from '../gpu/read-texture.ts';
import { UpscaleParameters } from '../layout/structs.ts';
import { upscale as upscaleTwin } from '../reference/upscale.ts';
import { uniformBuffer } from '../testing/gpu-buffers.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { upscale } from './upscale.ts';

const FORMAT = 'rgba32float';

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
      const device = await shareTestDevice();
      const pipelines = new Pipelines(device);
      // Depths go into a second target, here of the same format, which can be read back.
      const state = { topology: 'triangle-list', targets: [{ format: FORMAT }, { format: FORMAT }] } as const;
      const stage = upscale(true);
      await pipelines.prepare([[stage, { ...state, targets: [...state.targets] }]]);
      const random = seededRandom(51);
      const size = (px: readonly number[]) => ({ widthPx: px[0], heightPx: px[1] });
      const layers = [1, 1000].map((largest) =>
        Float32Array.from({ length: 4 * from[0] * from[1] }, () => largest * random()),
      );
      const [layer, depthLayer] = layers.map((values) => {
        const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST;
        const texture = device.createTexture({ size: from, format: FORMAT, usage });
        device.queue.writeTexture({ texture }, values, { bytesPerRow: 16 * from[0] }, from);
        return texture.createView();
      });
      const parameters = UpscaleParameters.pack({ layerPerPx: [from[0] / to[0], from[1] / to[1]] });
      const targets = layers.map(() =>
        device.createTexture({
          size: to,
          format: FORMAT,
          usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
        }),
      );
      const encoder = device.createCommandEncoder();
      const pass = encoder.beginRenderPass({
        colorAttachments: targets.map((texture) => ({
          view: texture.createView(),
          loadOp: 'clear',
          storeOp: 'store',
        })),
      });
      pass.setPipeline(pipelines.render(stage, { ...state, targets: [...state.targets] })!);
      const bindings = { parameters: uniformBuffer(device, parameters), layer, depthLayer };
      pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
      pass.draw(3);
      pass.end();
      device.queue.submit([encoder.finish()]);
      for (const [i, target] of targets.entries()) {
        const { data } = await readTexture(device, target);
        const expected = upscaleTwin(layers[i], size(from), size(to));
        // A place errs by some roundings of up to 16 px, and its value by that share of its neighbours' difference.
        const bound = 64 * 16 * 2 ** -24 * [1, 1000][i];
        for (const [at, value] of expected.entries())
          expect(Math.abs(data[at] - value), `value ${at}`).toBeLessThanOrEqual(bound);
      }
      device.destroy();
    });
  }
});
