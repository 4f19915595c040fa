import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { RepackParameters } from '../../data/layout/packing-structs.ts';
import { type PackedHarmonics, readCoefficients } from '../../data/packing/harmonics.ts';
import { packHarmonics, repackHarmonics } from '../../data/packing/repack-harmonics.ts';
import { coefficientsPerSplat } from '../../data/splats/splat-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { repackSh as reference } from './repack.reference.ts';
import { type RepackShVariant, repackSh } from './repack.ts';

const gpu = testGpu();

const COUNT = 700;
const DISPATCH_ROW = 2;

async function repackOnGpu(
  finer: PackedHarmonics,
  variant: RepackShVariant,
  shaders = gpu.pipelines,
): Promise<Uint32Array> {
  const stage = repackSh(variant);
  const contents = RepackParameters.pack({ splatCount: COUNT, dispatchRow: DISPATCH_ROW });
  const coarser = gpu.storage([], 4 * COUNT * stage.constants!.COARSER_WORDS);
  const bindings = {
    parameters: gpu.uniform(contents),
    finer: gpu.storage(finer.words),
    coarser,
  };
  const workgroups = Math.ceil(COUNT / CHUNK_SPLATS);
  await gpu.run(stage, bindings, dispatchSize(workgroups, DISPATCH_ROW), shaders);
  return gpu.read(coarser);
}

/** Random coefficients, and splats with none, tiny, huge and single ones. */
function coefficients(degree: RepackShVariant['degree']): PackedHarmonics {
  const { harmonics } = randomSplats({ count: COUNT, seed: 40 + degree, shDegree: degree });
  const width = coefficientsPerSplat(degree);
  for (const [i, value] of [0, 1e-9, 3e-6, 1e-3, 1, 65504, 65519, 1e30].entries()) {
    const rows = harmonics.coefficients.subarray(3 * i * width, 3 * (i + 1) * width);
    rows.fill(0).fill(-value, width, 2 * width);
    rows[3 * width - 1] = value;
  }
  return packHarmonics(harmonics);
}

describe('repack-sh', () => {
  gpuTest('halves that are truncated instead of rounded are noticed', async () => {
    const mutation = { file: 'lib/pack-splat', find: '0xfffu + ((magnitude >> 13u) & 1u)', replace: '0u' };
    const finer = coefficients(1);
    const cut = await repackOnGpu(
      finer,
      { degree: 1, from: 'f32', to: 'f16' },
      new Pipelines(gpu.device, mutation),
    );
    expect(cut).not.toEqual(reference(finer, COUNT, 'f16').words);
  });

  for (const degree of [1, 2, 3] as const) {
    gpuTest(`degree ${degree}: f32 to f16 equals the host's bit for bit`, async () => {
      const finer = coefficients(degree);
      const words = await repackOnGpu(finer, { degree, from: 'f32', to: 'f16' });
      expect(words).toEqual(reference(finer, COUNT, 'f16').words);
    });

    for (const from of ['f32', 'f16'] as const) {
      gpuTest(`degree ${degree}: ${from} to u8 equals the host's to within one step`, async () => {
        const finer = repackHarmonics(coefficients(degree), COUNT, from);
        const expected = reference(finer, COUNT, 'u8');
        const made = { ...expected, words: await repackOnGpu(finer, { degree, from, to: 'u8' }) };
        const [a, b] = [0, 1].map(() => new Float64Array(coefficientsPerSplat(degree)));
        let differing = 0;
        for (let i = 0; i < COUNT; i++) {
          const scaleBits = made.words[i * made.wordsPerSplat] & 0xffff;
          expect(scaleBits, `scale of splat ${i}`).toBe(expected.words[i * made.wordsPerSplat] & 0xffff);
          readCoefficients(made, i, a);
          readCoefficients(expected, i, b);
          const step = Math.max(...b.map(Math.abs)) / 127;
          for (const [k, value] of b.entries()) {
            if (a[k] === value) continue;
            differing++;
            expect(Math.abs(a[k] - value), `splat ${i}, value ${k}`).toBeLessThanOrEqual(1.01 * step);
          }
        }
        // Steps differ where float32 and float64 fall to different sides of half a step.
        expect(differing).toBeLessThanOrEqual((COUNT * coefficientsPerSplat(degree)) / 1000);
      });
    }
  }
});
