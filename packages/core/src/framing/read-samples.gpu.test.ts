import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { createEngine, SplatEngine } from '../create-engine.ts';
import { SplatSourceError } from '../data/errors.ts';
import { identity4 } from '../data/math/mat4.ts';
import { packCloud } from '../data/packing/packed-cloud.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { encodePly } from '../io/formats/ply/write-ply.ts';
import { deviceWith, limitsWith } from '../testing/device-with.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { signalOf } from '../testing/signal.ts';
import { slowFile } from '../testing/slow-file.ts';
import { readSamples } from './read-samples.ts';
import type { SplatSample } from './samples.ts';
import { decodeSamples } from './splat-decoder.ts';

const COUNT = 1500;
const SET = randomSplats({ count: COUNT, shDegree: 1 });
const AT_HOME = identity4();
/** x to y, y to z, z to x, twice as large, and moved. */
const TURNED = [0, 2, 0, 0, 0, 0, 2, 0, 2, 0, 0, 0, 10, 20, 30, 1];

let device: GPUDevice;
let engine: SplatEngine;
/** Has clouds of several pages, and takes files in small pieces. */
let narrow: SplatEngine;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({ device });
  const limits = limitsWith(device, { maxStorageBufferBindingSize: 64 * 768 });
  narrow = await createEngine({ device: deviceWith(device, { limits }) }, { ingestMinRows: 1 });
});

/** Sampled splats of a cloud in the world, and the number of the instance of each. */
async function sampleOf(
  cloud: SplatCloud,
  matrices: readonly ArrayLike<number>[] = [AT_HOME],
  most?: number,
) {
  const placed = { cloud, matrices, opacities: matrices.map(() => 1) };
  const { samples, weight } = await readSamples([placed], undefined, most);
  return { ...decodeSamples(samples, weight), instances: samples[0].instances };
}

/** Expects sample `i` to be row `row` of a set, at `TURNED` or where it is. */
function expectRow(sample: SplatSample, i: number, set: SplatSet, row: number, isTurned = false): void {
  const [x, y, z] = [0, 1, 2].map((axis) => set.origin[axis] + set.positions[3 * row + axis]);
  const place = isTurned ? [2 * z + 10, 2 * x + 20, 2 * y + 30] : [x, y, z];
  for (const [axis, value] of place.entries())
    expect(Math.abs(sample.positions[3 * i + axis] - value)).toBeLessThan(1e-6);
  const sizes = Float64Array.from(set.logScales.subarray(3 * row, 3 * row + 3), Math.exp).sort();
  for (const [k, size] of sizes.entries())
    expect(sample.sigmas[3 * i + k] / (isTurned ? 2 * size : size)).toBeCloseTo(1, 3);
  expect(sample.opacities[i]).toBeCloseTo(1 / (1 + Math.exp(-set.opacityLogits[row])), 4);
  for (let channel = 0; channel < 3; channel++)
    expect(sample.colors[3 * i + channel]).toBeCloseTo(set.colorDc[3 * row + channel], 2);
}

describe('splats that are sampled', () => {
  for (const geometryPrecision of ['packed', 'f32'] as const)
    gpuTest(`are those of all instances of a cloud, ${geometryPrecision}, wherever it lies`, async () => {
      const set = randomSplats({ count: COUNT, shDegree: 1, origin: [1e7, -5, 3] });
      const cloud = engine.addPacked(packCloud(set, { geometryPrecision, shPrecision: 'u8' }));
      const sample = await sampleOf(cloud, [AT_HOME, TURNED]);
      expect([sample.count, sample.weight]).toEqual([2 * COUNT, 1]);
      for (let i = 0; i < 2 * COUNT; i++)
        expectRow(sample, i, set, cloud.fileIndices[i >> 1], sample.instances[i] === 1);
      cloud.destroy();
    });

  gpuTest('are spread over the storage of a cloud that has more, on all of its pages', async () => {
    const cloud = narrow.add(SET);
    expect(cloud.planes.ranges).toHaveLength(2);
    const sample = await sampleOf(cloud, [AT_HOME], 100);
    expect([sample.count, sample.weight]).toEqual([100, COUNT / 100]);
    for (let i = 0; i < 100; i++) expectRow(sample, i, SET, cloud.fileIndices[Math.floor((i * COUNT) / 100)]);
    cloud.destroy();
  });

  gpuTest('are packed ones, if there are both', async () => {
    const cloud = engine.addPacked(packCloud(SET, { geometryPrecision: 'f32', shPrecision: 'u8' }));
    const fine = await sampleOf(cloud);
    await cloud.hold({ geometryPrecision: 'packed', shPrecision: 'u8' }).met;
    const both = await sampleOf(cloud);
    cloud.ownLease.release();
    expect(cloud.precisions.geometry).toEqual(['packed']);
    expect(await sampleOf(cloud)).toEqual(both);
    expect(both).not.toEqual(fine);
    cloud.destroy();
  });

  gpuTest('are those that have arrived of a file, until it is put in order', async () => {
    const bytes = encodePly(SET);
    const cut = Math.floor(0.6 * bytes.length);
    const rest = signalOf();
    const file = slowFile('a.ply', bytes, [bytes.subarray(0, cut), bytes.subarray(cut)], () => rest.when);
    const checks: Promise<void>[] = [];
    const early: SplatCloud[] = [];
    const cloud = await narrow.load(file, {
      onPreview: (preview) => {
        early.push(preview);
        if (early.length > 1) return;
        const check = async () => {
          const sample = await sampleOf(preview);
          expect(sample.count).toBe(preview.count);
          expect(sample.count).toBeGreaterThan(100);
          for (let i = 0; i < sample.count; i++) expectRow(sample, i, SET, i);
          const change = signalOf();
          preview.holdImage(change.when);
          await expect(sampleOf(preview)).rejects.toThrow(SplatSourceError);
          change.give();
          await preview.heldUntil;
        };
        checks.push(check().finally(rest.give));
      },
    });
    expect(checks).toHaveLength(1);
    await Promise.all(checks);
    expect(await sampleOf(early.at(-1)!)).toEqual(await sampleOf(cloud));
    cloud.destroy();
  });
});
