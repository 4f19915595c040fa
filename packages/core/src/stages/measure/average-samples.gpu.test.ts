import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { readTexture } from '../../gpu/read-texture.ts';
import { colorTexture } from '../../testing/gpu-textures.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { averageSamples as reference } from './measure.reference.ts';
import { averageSamples, SAMPLES_PER_SIDE } from './measure.ts';

const gpu = testGpu();

for (const [widthPx, heightPx] of [
  [1, 1],
  [8, 8],
  [13, 5],
]) {
  gpuTest(`average-samples averages to ${widthPx}×${heightPx} px`, async () => {
    const random = seededRandom(23);
    const fine = { widthPx: SAMPLES_PER_SIDE * widthPx, heightPx: SAMPLES_PER_SIDE * heightPx };
    const samples = Float32Array.from({ length: 4 * fine.widthPx * fine.heightPx }, () => 2 * random());
    const image = gpu.device.createTexture({
      size: [widthPx, heightPx],
      format: 'rgba32float',
      usage: GPUTextureUsage.STORAGE_BINDING | GPUTextureUsage.COPY_SRC,
    });
    const bindings = {
      samples: colorTexture(gpu.device, samples, fine).createView(),
      image: image.createView(),
    };
    const tiles = [widthPx, heightPx].map((px) => Math.ceil(px / SHADER_CONSTANTS.IMAGE_TILE_PX));
    await gpu.run(averageSamples, bindings, [tiles[0], tiles[1], 1]);
    const { data } = await readTexture(gpu.device, image);
    const expected = reference(samples, { widthPx, heightPx }, SAMPLES_PER_SIDE);
    // Sums of up to 32 are rounded 16 times.
    const farthest = Math.max(...expected.map((value, i) => Math.abs(value - data[i])));
    expect(farthest).toBeLessThan(2 ** -21);
    // The mean of the neighbouring samples is another.
    const beside = reference(samples.subarray(4), { widthPx, heightPx: heightPx - 1 }, SAMPLES_PER_SIDE);
    for (const [i, value] of beside.entries()) expect(Math.abs(value - data[i])).toBeGreaterThan(2 ** -21);
  });
}
