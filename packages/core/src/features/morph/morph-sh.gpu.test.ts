import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { MorphParameters } from '../../data/layout/packing-structs.ts';
import { type PackedHarmonics, readCoefficients } from '../../data/packing/harmonics.ts';
import type { OwnShPrecision } from '../../data/packing/precision.ts';
import { packHarmonics, repackHarmonics } from '../../data/packing/repack-harmonics.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { dispatchSize } from '../../stages/dispatch.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { morphSh as reference } from './morph.reference.ts';
import { morphSh } from './morph.stages.ts';

const gpu = testGpu();

const COUNT = 700;
const DISPATCH_ROW = 2;
/** Coefficients are ±0.3. Steps of bytes may be one apart where float32 rounds to the other. */
const ALLOWED: Readonly<Record<OwnShPrecision, number>> = {
  f32: 1e-7,
  f16: 2 ** -12,
  u8: 1.01 * (0.3 / 127),
};

function statesOf(degree: ShDegree, precision: OwnShPrecision): [PackedHarmonics, PackedHarmonics] {
  const [first, second] = [71, 72].map((seed) => {
    const { harmonics } = randomSplats({ count: COUNT, seed, shDegree: degree });
    // A splat without any.
    harmonics.coefficients.fill(0, 0, coefficientsPerSplat(degree));
    return repackHarmonics(packHarmonics(harmonics), COUNT, precision);
  });
  return [first, second];
}

async function morphOnGpu(
  [first, second]: readonly [PackedHarmonics, PackedHarmonics],
  amount: number,
  shaders = gpu.pipelines,
): Promise<PackedHarmonics> {
  const contents = MorphParameters.pack({ splatCount: COUNT, dispatchRow: DISPATCH_ROW, amount });
  const morphed = gpu.storage([], 4 * COUNT * first.wordsPerSplat);
  const bindings = {
    parameters: gpu.uniform(contents),
    first: gpu.storage(first.words),
    second: gpu.storage(second.words),
    morphed,
  };
  const workgroups = dispatchSize(Math.ceil(COUNT / CHUNK_SPLATS), DISPATCH_ROW);
  await gpu.run(morphSh(first.degree, first.precision), bindings, workgroups, shaders);
  return { ...first, words: await gpu.read(morphed) };
}

function largestError(made: PackedHarmonics, expected: PackedHarmonics): number {
  const width = coefficientsPerSplat(made.degree);
  const [a, b] = [new Float64Array(width), new Float64Array(width)];
  let largest = 0;
  for (let i = 0; i < COUNT; i++) {
    readCoefficients(made, i, a);
    readCoefficients(expected, i, b);
    for (let k = 0; k < width; k++) largest = Math.max(largest, Math.abs(a[k] - b[k]));
  }
  return largest;
}

describe('morph-sh', () => {
  for (const degree of [1, 2, 3] as const) {
    for (const precision of ['f32', 'f16', 'u8'] as const) {
      gpuTest(`blends as the reference does, degree ${degree}, ${precision}`, async () => {
        const states = statesOf(degree, precision);
        for (const amount of [0, 0.3, 1]) {
          const expected = reference(...states, COUNT, amount);
          const made = await morphOnGpu(states, amount);
          expect(largestError(made, expected), `${amount}`).toBeLessThan(ALLOWED[precision]);
        }
      });
    }
  }

  gpuTest('the first set alone is noticed', async () => {
    const find = 'b * parameters.amount';
    const replace = 'a * parameters.amount';
    const states = statesOf(1, 'u8');
    const shaders = new Pipelines(gpu.device, { file: 'stages/morph-sh', find, replace });
    const made = await morphOnGpu(states, 0.3, shaders);
    expect(largestError(made, reference(...states, COUNT, 0.3))).toBeGreaterThan(10 * ALLOWED.u8);
  });
});
