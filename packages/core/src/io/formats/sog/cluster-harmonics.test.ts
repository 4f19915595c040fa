import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import type { HarmonicsPalette } from '../../../data/packing/harmonics-palette.ts';
import { packHarmonics } from '../../../data/packing/repack-harmonics.ts';
import {
  coefficientsPerSplat,
  type ShDegree,
  type TrainedHarmonics,
} from '../../../data/splats/splat-set.ts';
import { seededRandom } from '../../../testing/seeded-random.ts';
import { type ClusterOptions, clusterHarmonics } from './cluster-harmonics.ts';

/** Harmonics of `count` splats near a few centres, at most `spread` off in each coefficient. */
function around(centres: number, count: number, degree: ShDegree, spread: number): TrainedHarmonics {
  const random = seededRandom(centres + count);
  const length = coefficientsPerSplat(degree);
  const means = Float32Array.from({ length: centres * length }, () => 2 * random() - 1);
  const coefficients = new Float32Array(count * length);
  for (let i = 0; i < count; i++)
    for (let k = 0; k < length; k++)
      coefficients[i * length + k] = means[(i % centres) * length + k] + spread * (2 * random() - 1);
  return { degree, coefficients };
}

const countOf = ({ degree, coefficients }: TrainedHarmonics) =>
  coefficients.length / coefficientsPerSplat(degree);
const cluster = (harmonics: TrainedHarmonics, options: ClusterOptions) =>
  clusterHarmonics(harmonics, countOf(harmonics), options);
const entryCountOf = ({ degree, entries }: HarmonicsPalette) => entries.length / coefficientsPerSplat(degree);

/** The coefficients of each splat by the palette. */
function expanded({ degree, entries, indices }: HarmonicsPalette): Float32Array {
  const length = coefficientsPerSplat(degree);
  return Float32Array.from({ length: indices.length * length }, (_, i) => {
    return entries[indices[Math.floor(i / length)] * length + (i % length)];
  });
}

const rmsOf = (values: Float32Array, others: Float32Array) =>
  Math.sqrt(values.reduce((sum, value, i) => sum + (value - others[i]) ** 2, 0) / values.length);

describe('no more different harmonics than entries: all are kept, bit for bit', () => {
  test.each<[ShDegree, number, number]>([
    [1, 1, 1],
    [1, 7, 7],
    [2, 60, 64],
    [3, 60, 400],
  ])('degree %i, %i splats, %i entries', async (degree, count, entryCount) => {
    const harmonics = around(count, count, degree, 0);
    const palette = await cluster(harmonics, { entryCount });
    expect(expanded(palette)).toEqual(harmonics.coefficients);
    expect(entryCountOf(palette)).toBe(count);
  });

  test('many splats that share a few', async () => {
    const harmonics = around(50, 1000, 2, 0);
    const palette = await cluster(harmonics, { entryCount: 1024 });
    expect(entryCountOf(palette)).toBe(50);
    expect(expanded(palette)).toEqual(harmonics.coefficients);
  });

  test('splats that are all alike', async () => {
    for (const value of [0, 0.1, -3e20]) {
      const coefficients = new Float32Array(9 * 100).fill(value);
      const palette = await cluster({ degree: 1, coefficients }, { entryCount: 16 });
      expect([...palette.entries]).toEqual(new Array(9).fill(Math.fround(value)));
    }
  });

  test('no harmonics, and no splats', async () => {
    const none = { degree: 0, coefficients: new Float32Array(0) } as const;
    const palette = await clusterHarmonics(none, 5, { entryCount: 4 });
    expect(palette).toEqual({ degree: 0, entries: new Float32Array(0), indices: new Uint16Array(5) });
    const empty = await cluster({ degree: 2, coefficients: new Float32Array(0) }, { entryCount: 4 });
    expect(empty.indices.length).toBe(0);
  });
});

/** Of values that are uniform from −1 to 1. */
const RMS_OF_UNIT = 1 / Math.sqrt(3);

describe('more different harmonics than entries', () => {
  test('groups that lie apart are told apart', async () => {
    const harmonics = around(32, 3200, 2, 0.01);
    // Some groups are divided while others still are together.
    const palette = await cluster(harmonics, { entryCount: 128 });
    expect(rmsOf(expanded(palette), harmonics.coefficients)).toBeLessThan(RMS_OF_UNIT * 0.01);
  });

  test('entries are the means of their splats, and nearly all splats have the nearest entry', async () => {
    const harmonics = around(200, 4000, 1, 1);
    const palette = await cluster(harmonics, { entryCount: 128 });
    const { entries, indices } = palette;
    const { coefficients } = harmonics;
    const sums = new Float64Array(entries.length);
    const counts = new Uint32Array(entryCountOf(palette));
    let nearest = 0;
    for (let i = 0; i < indices.length; i++) {
      counts[indices[i]]++;
      const distances = Array.from(counts, (_, entry) => {
        let sum = 0;
        for (let k = 0; k < 9; k++) sum += (coefficients[9 * i + k] - entries[9 * entry + k]) ** 2;
        return sum;
      });
      for (let k = 0; k < 9; k++) sums[9 * indices[i] + k] += coefficients[9 * i + k];
      if (distances[indices[i]] <= Math.min(...distances) * 1.05) nearest++;
    }
    expect(Math.min(...counts)).toBeGreaterThan(0);
    sums.forEach((sum, i) => {
      expect(entries[i]).toBeCloseTo(sum / counts[Math.floor(i / 9)], 5);
    });
    expect(nearest / indices.length).toBeGreaterThan(0.95);
  });

  test('splats outside of the sample find their entry', async () => {
    const harmonics = around(32, 3200, 1, 0.01);
    const palette = await cluster(harmonics, { entryCount: 128, mostSampled: 1000 });
    expect(rmsOf(expanded(palette), harmonics.coefficients)).toBeLessThan(RMS_OF_UNIT * 0.01);
  });

  test('columns that do not vary stay as they are', async () => {
    const harmonics = around(500, 2000, 2, 0.1);
    const column = (values: Float32Array) => values.filter((_, i) => i % 24 === 7);
    harmonics.coefficients.forEach((_, i) => {
      if (i % 24 === 7) harmonics.coefficients[i] = 0.25;
    });
    const palette = await cluster(harmonics, { entryCount: 32 });
    expect(new Set(column(palette.entries))).toEqual(new Set([0.25]));
  });

  test('the same again, and from packed harmonics', async () => {
    const harmonics = around(500, 2000, 1, 0.5);
    const palette = await cluster(harmonics, { entryCount: 100 });
    expect(await cluster(harmonics, { entryCount: 100 })).toEqual(palette);
    const packed = packHarmonics(harmonics);
    expect(await clusterHarmonics(packed, 2000, { entryCount: 100 })).toEqual(palette);
  });
});

test.each([0, 65_537, 1.5, Number.NaN])('%d entries are refused', async (entryCount) => {
  const clustering = cluster(around(1, 1, 1, 0), { entryCount });
  await expect(clustering).rejects.toThrow(InvalidArgumentError);
});

test('it tells how far it is, and ends when it is aborted', async () => {
  const harmonics = around(500, 3000, 1, 0.5);
  const told: number[] = [];
  await cluster(harmonics, { entryCount: 64, onProgress: (fraction) => told.push(fraction) });
  expect(told.at(-1)).toBe(1);
  expect(told).toEqual([...told].sort((a, b) => a - b));
  const signal = AbortSignal.abort('no longer wanted');
  await expect(cluster(harmonics, { entryCount: 64, signal })).rejects.toBe('no longer wanted');
  const controller = new AbortController();
  const onProgress = () => controller.abort('enough');
  const clustering = cluster(harmonics, { entryCount: 64, signal: controller.signal, onProgress });
  await expect(clustering).rejects.toBe('enough');
});
