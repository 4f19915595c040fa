import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { packSet } from '../../data/packing/pack-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { childrenOf, type MadeCell, type MadeNode, madeLevels } from '../../testing/made-levels.ts';
import { paletteSplats } from '../../testing/palette-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { type LevelNode, mergedCoefficients } from './merge.reference.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';
const gpu = testGpu();

/** Expects a blob's coefficients to be those of its leaves by weight, to within a byte's steps. */
function expectAveraged(cell: MadeCell): void {
  const children = childrenOf(cell);
  const coefficients = new Map<LevelNode, Float64Array>();
  const nodeOf = (made: MadeNode): LevelNode => {
    const node = { merged: made.merged, error: 0, children: (children.get(made) ?? []).map(nodeOf) };
    coefficients.set(node, made.coefficients);
    return node;
  };
  const blobs = cell.blobs.filter((blob) => blob !== undefined);
  expect(blobs.length).toBeGreaterThan(0);
  for (const blob of blobs) {
    const expected = mergedCoefficients(nodeOf(blob), (leaf) => coefficients.get(leaf)!);
    const step = Math.max(...expected.map(Math.abs)) / 127;
    for (const [k, value] of expected.entries())
      if (!(Math.abs(blob.coefficients[k] - value) <= 0.51 * step + 1e-6))
        expect.fail(`blob ${blob.slot} of cell ${blob.cell}, ${k}: ${blob.coefficients[k]} for ${value}`);
  }
}

describe('merge-harmonics', () => {
  // In the first tier, each form once, and each degree.
  for (const [geometryPrecision, shPrecision, shown] of [
    ['f32', 'f32', 1],
    ['f32', 'f16', 2],
    ['f32', 'u8', 3],
    ['packed', 'u8', 2],
  ] as const) {
    for (const shDegree of isFull ? ([1, 2, 3] as const) : ([shown] as const)) {
      const name = `degree ${shDegree}, ${shPrecision}, ${geometryPrecision}: averages by weight`;
      gpuTest(name, { tags: 'deeper' }, async () => {
        const set = randomSplats({ count: 1100, seed: shDegree, shDegree });
        const cells = await madeLevels(gpu, packSet(set, { geometryPrecision, shPrecision }));
        for (const cell of cells) expectAveraged(cell);
      });
    }
  }

  gpuTest('a palette', async () => {
    const set = paletteSplats({ count: 600, shDegree: 2, entryCount: 40 });
    const packed = packSet(set, { geometryPrecision: 'packed', shPrecision: 'palette' });
    for (const cell of await madeLevels(gpu, packed)) expectAveraged(cell);
  });

  gpuTest('a fault is noticed', async () => {
    const [find, replace] = ['(weight0 + weight1)', '(weight0 + 1.1 * weight1)'];
    const pipelines = new Pipelines(gpu.device, { file: 'stages/merge-harmonics', find, replace });
    const packed = packSet(randomSplats({ count: 300, shDegree: 1 }), {
      geometryPrecision: 'f32',
      shPrecision: 'f32',
    });
    const cells = await madeLevels(gpu, packed, { pipelines });
    expect(() => {
      for (const cell of cells) expectAveraged(cell);
    }).toThrow('of cell');
  });
});
