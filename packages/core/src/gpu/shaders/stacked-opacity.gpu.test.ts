import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { cutoffGaussian, stackedAlpha } from '../../reference/stacked-opacity.ts';
import { familyTexts } from '../../stages/family-texts.ts';
import { testGpu } from '../../testing/test-gpu.ts';

const gpu = testGpu();

/** Writes the result of a function of the library for each pair of numbers. */
const stageOf = (name: string) => {
  const text = `
    import package::lib::stacked_opacity::${name};
    @group(0) @binding(0) var<storage, read> pairs: array<vec2f>;
    @group(0) @binding(1) var<storage, read_write> results: array<f32>;
    @compute @workgroup_size(64)
    fn evaluate(@builtin(global_invocation_id) thread: vec3u) {
      if (thread.x < arrayLength(&pairs)) {
        results[thread.x] = ${name}(pairs[thread.x].x, pairs[thread.x].y);
      }
    }`;
  return { stage: name, texts: familyTexts({ [`${name}.wgsl`]: text }), entryPoint: 'evaluate' };
};

/** Returns the results with the numbers that the GPU read. */
async function evaluated(name: string, inputs: readonly (readonly [number, number])[]) {
  const pairs = Float32Array.from(inputs.flat());
  const results = gpu.storage([], 4 * inputs.length);
  await gpu.run(stageOf(name), { pairs: gpu.storage(pairs), results }, [Math.ceil(inputs.length / 64), 1, 1]);
  const values = new Float32Array((await gpu.read(results)).buffer);
  return inputs.map((_, i) => ({ opacity: pairs[2 * i], x: pairs[2 * i + 1], value: values[i] }));
}

const pairsOf = (opacities: readonly number[], others: readonly number[]) =>
  opacities.flatMap((opacity) => others.map((other) => [opacity, other] as const));

/** From `first` to `last`, as far apart as multiples. */
const spread = (first: number, last: number, count: number) =>
  Array.from({ length: count }, (_, i) => first * (last / first) ** (i / (count - 1)));

const MERGED = [1.0001, ...spread(1.001, 1000, 60)];

describe('the opacity of merged splats', () => {
  gpuTest('is within 5e-6 of its value for Gaussians from 1e-7 to 1', async () => {
    const gaussians = [...spread(1e-7, 1, 200), ...spread(1e-7, 0.5, 50).map((rest) => 1 - rest)];
    for (const { opacity, x, value } of await evaluated('stackedAlpha', pairsOf(MERGED, gaussians))) {
      const expected = stackedAlpha(opacity, x);
      expect(Math.abs(value / expected - 1), `${opacity} at ${x}`).toBeLessThan(5e-6);
    }
  });

  gpuTest('is the product, to the bit, up to an opacity of 1; 1 and 0 at both ends', async () => {
    const pairs = pairsOf([0, ...spread(1e-3, 1, 40)], [0, ...spread(1e-12, 1, 40)]);
    for (const { opacity, x, value } of await evaluated('stackedAlpha', pairs))
      expect(value).toBe(Math.fround(opacity * x));
    const ends = await evaluated('stackedAlpha', pairsOf(MERGED, [0, 1]));
    for (const { opacity, x, value } of ends) expect(value, `${opacity} at ${x}`).toBe(x);
  });

  gpuTest('falls to a cutoff where its Gaussian is within 1e-6 of its value', async () => {
    const cutoffs = [1 / 255, 1 / 128, ...spread(1 / 4096, 0.1, 40)];
    for (const { opacity, x, value } of await evaluated('cutoffGaussian', pairsOf(MERGED, cutoffs))) {
      const expected = cutoffGaussian(opacity, x);
      expect(stackedAlpha(opacity, expected) / x).toBeCloseTo(1, 12);
      expect(Math.abs(value / expected - 1), `${opacity} at ${x}`).toBeLessThan(1e-6);
    }
  });
});
