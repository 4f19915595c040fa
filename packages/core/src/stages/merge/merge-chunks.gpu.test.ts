import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { cellCounts, childCell } from '../../data/layout/cell-counts.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { packSet } from '../../data/packing/pack-set.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { blobError, linkParts } from '../../reference/level-link.ts';
import { blobOpacity, type Merged, merge, mergeCost } from '../../reference/merged-splat.ts';
import { childrenOf, isRoot, type MadeCell, type MadeNode, madeLevels } from '../../testing/made-levels.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { mergeCell } from './merge.reference.ts';

const { CELL_ROOTS } = LEVEL_CONSTANTS;
const gpu = testGpu();
const isFull = process.env.WEBSPLATTER_FULL === '1';

const cellsOf = (set: SplatSet, geometryPrecision: GeometryPrecision = 'f32', options = {}) =>
  madeLevels(gpu, packSet(set, { geometryPrecision, shPrecision: 'f32' }), options);

/** An expectation of one of tens of thousands of nodes, each of which would take microseconds. */
function must(isAsExpected: boolean, at: string): void {
  if (!isAsExpected) expect.fail(at);
}

/** Expects blobs to be what their children are together, and links to be as documented. */
function expectMerged(cell: MadeCell): void {
  const blobs = cell.blobs.filter((blob) => blob !== undefined);
  const leaves = cell.leaves.filter((leaf) => leaf !== undefined);
  const roots = blobs.filter(isRoot);
  expect(roots.length).toBe(Math.min(CELL_ROOTS, leaves.length));
  expect(blobs.length).toBe(cell.blobHead[5]);
  const children = childrenOf(cell);
  for (const [blob, nodes] of children) {
    const at = `blob ${blob.slot} of cell ${blob.cell}`;
    const { error } = linkParts(blob.link);
    for (const { link } of nodes) {
      const child = linkParts(link);
      must(child.parentError === error, `${at}: ${child.parentError} is not its error, ${error}`);
      must(child.error <= error, `${at}: an error of ${child.error} in ${error}`);
    }
    must(nodes.length === (blob.slot < cell.blobHead[6] ? 2 : 1), `${at}: ${nodes.length} children`);
    const [a, b] = nodes.map(({ merged }) => merged);
    const own = Math.max(...nodes.map(({ link }) => linkParts(link).error));
    if (!b) {
      must(isRoot(blob) && error === Math.max(1, own), `${at}: a copy with an error of ${error}`);
      expectSame(blob.merged, a, at);
      continue;
    }
    // Blobs that nothing shows have no weight of their own.
    if (nodes.some(({ splat }) => splat.opacity < 1e-6)) continue;
    expectSame(blob.merged, merge(a, b), at);
    const expected = Math.max(blobError(Math.sqrt(mergeCost(a, b))), own);
    must(Math.abs(error - expected) <= 1, `${at}: an error of ${error} for ${expected}`);
    const opacity = blobOpacity(merge(a, b), blob.splat);
    must(Math.abs(blob.splat.opacity / opacity - 1) < 5e-4, `${at}: ${blob.splat.opacity} for ${opacity}`);
  }
}

/** Expects moments to agree to float32's rounding, relative to the blob's size. */
function expectSame(actual: Merged, expected: Merged, at: string): void {
  const size = Math.sqrt(expected.covariance.slice(0, 3).reduce((sum, variance) => sum + variance, 0));
  const far = Math.max(...expected.center.map(Math.abs), size);
  const near = (a: readonly number[], b: readonly number[], tolerance: number, what: string) => {
    for (const [i, value] of a.entries())
      if (!(Math.abs(value - b[i]) <= tolerance)) expect.fail(`${at}, ${what}: ${a} for ${b}`);
  };
  near(actual.center, expected.center, 1e-5 * size + 4e-7 * far, 'centre');
  near(actual.covariance, expected.covariance, 2e-5 * size ** 2, 'covariance');
  near(actual.color, expected.color, 1e-4, 'colour');
  near(actual.sums, expected.sums, 1e-4 * Math.max(...expected.sums.map(Math.abs)), 'sums');
}

const numbersOf = ({ position, opacity, rotation, scale, colorDc }: MadeNode['splat']) =>
  Float64Array.from([...position, opacity, ...rotation, ...scale, ...colorDc]);

/** All that was made, as arrays, whose bytes are compared at once. */
function valuesOf(cells: readonly MadeCell[]) {
  const nodes = cells.flatMap(({ leaves, blobs }) => [...leaves, ...blobs]);
  return {
    heads: cells.flatMap(({ leafHead, blobHead }) => [leafHead, blobHead]),
    links: Uint32Array.from(nodes, (node) => node?.link ?? 0),
    splats: Float64Array.from(
      nodes.flatMap((node) => (node ? [...numbersOf(node.splat), ...node.merged.sums] : [])),
    ),
  };
}

/** Expects leaves above the chunks to be the roots of the level below. */
function expectPromoted(cells: readonly MadeCell[], count: number): void {
  const counts = cellCounts(chunkCountOf(count));
  for (const [i, cell] of cells.entries()) {
    if (i < counts[0]) continue;
    for (const leaf of cell.leaves) {
      if (!leaf) continue;
      const below = cells[childCell(counts, leaf)];
      const root = below.blobs.filter((blob) => blob && isRoot(blob))[leaf.slot % CELL_ROOTS]!;
      expect(numbersOf(leaf.splat)).toEqual(numbersOf(root.splat));
      must(linkParts(leaf.link).error === below.blobHead[1], `leaf ${leaf.slot} of cell ${i}: its error`);
    }
  }
  const promoted = cells.slice(counts[0]).flatMap(({ leaves }) => leaves.filter((leaf) => leaf));
  const roots = cells.slice(0, -1).flatMap(({ blobs }) => blobs.filter((blob) => blob && isRoot(blob)));
  expect(promoted.length).toBe(roots.length);
}

describe('merge-chunks', () => {
  for (const geometryPrecision of ['f32', 'packed'] as const) {
    // Only reading differs by precision.
    for (const count of isFull || geometryPrecision === 'f32' ? [1, 16, 17, 255, 257, 5000] : [1, 257]) {
      gpuTest(
        `${count} splats, ${geometryPrecision}: blobs are their children together`,
        { tags: 'deeper' },
        async () => {
          const cells = await cellsOf(randomSplats({ count, seed: count, shDegree: 0 }), geometryPrecision);
          for (const cell of cells) expectMerged(cell);
          expectPromoted(cells, count);
        },
      );
    }
  }

  gpuTest('merges the pairs that the reference merges', async () => {
    const cells = await cellsOf(randomSplats({ count: 700, seed: 5, shDegree: 0 }));
    for (const cell of cells.slice(0, 3)) {
      const leaves = cell.leaves.filter((leaf) => leaf !== undefined);
      const expected = mergeCell(leaves.map(({ merged }) => merged));
      const errors = expected.blobs.map(({ error }) => error);
      const made = cell.blobs.flatMap((blob) => (blob ? [linkParts(blob.link).error] : []));
      expect(made.length).toBe(errors.length);
      const differing = made.filter((error, i) => Math.abs(error - errors[i]) > 1).length;
      // Costs that float32 and float64 order differently change the pairs after them.
      expect(differing).toBeLessThan(0.1 * made.length);
      expect(cell.blobHead[1]).toBe(Math.max(...expected.roots.map(({ error }) => error)));
    }
  });

  gpuTest('pages, and dispatches of any row, make no difference', async () => {
    const set = randomSplats({ count: 5000, seed: 2, shDegree: 0 });
    const whole = valuesOf(await cellsOf(set));
    const paged = await cellsOf(set, 'f32', { bytesPerPage: 64 * 256 * 3, dispatchRow: 1 });
    expect(valuesOf(paged)).toEqual(whole);
  });

  const hard: Record<string, (set: SplatSet, i: number) => void> = {
    needles: ({ logScales }, i) => logScales.set([-1, -9, -9], 3 * i),
    'splats in one place': ({ positions }, i) => positions.set([1, 2, 3], 3 * i),
    'splats of one place, size and colour': ({ positions, logScales, colorDc }, i) => {
      positions.set([1, 2, 3], 3 * i);
      logScales.set([-3, -3, -3], 3 * i);
      colorDc.set([0, 0, 0], 3 * i);
    },
    'splats that nothing shows': ({ opacityLogits }, i) => opacityLogits.fill(-80, i, i + 1),
    'opaque splats': ({ opacityLogits }, i) => opacityLogits.fill(80, i, i + 1),
    'one splat as large as the scene, and floaters': ({ logScales, positions }, i) => {
      if (i === 7) logScales.set([3, 3, 3], 21);
      if (i % 50 === 0) positions[3 * i] = 1e6;
    },
    'colours far beyond white and black': ({ colorDc }, i) => colorDc.set([-900, 0, 900], 3 * i),
    'a scene of 1e-9': ({ positions, logScales }, i) => {
      for (const at of [3 * i, 3 * i + 1, 3 * i + 2])
        [positions[at], logScales[at]] = [positions[at] * 1e-9, logScales[at] - 20];
    },
    'a scene of 1e9': ({ positions, logScales }, i) => {
      for (const at of [3 * i, 3 * i + 1, 3 * i + 2])
        [positions[at], logScales[at]] = [positions[at] * 1e9, logScales[at] + 20];
    },
  };
  for (const [name, change] of Object.entries(hard)) {
    gpuTest(`${name}: merged`, async () => {
      const set = randomSplats({ count: 600, seed: 3, shDegree: 0 });
      for (let i = 0; i < set.count; i++) change(set, i);
      for (const cell of await cellsOf(set)) expectMerged(cell);
    });
  }

  const faults = [
    ['lib/merged-splat', 'moved * apart * apart', '0.9 * moved * apart * apart'],
    ['lib/merged-splat', 'weight * moved * apart2', '1.5 * weight * moved * apart2'],
    ['lib/merged-splat', 'COLOR_COST * trace', '2.0 * trace'],
    ['lib/merged-splat', 'SHAPE_COST * shapes', '0.0 * shapes'],
    ['lib/merged-splat', 'return overlap / 6.0', 'return overlap / 6.5'],
    ['lib/merged-splat', '(12.0 * x * x * x)) - 0.5', '(12.0 * x * x * x)) - 0.49'],
    ['lib/level-link', '((1u << ERROR_SHIFT) - 1u)', '(3u << ERROR_SHIFT)'],
    ['stages/merge-chunks', 'max(own.error, order[other])', 'own.error'],
    ['stages/merge-chunks', 'own.sums += vec2f', 'own.sums += 0.99 * vec2f'],
  ];
  /** One of each file. */
  const some = faults.filter(([file], i) => i === 0 || file !== faults[i - 1][0]);
  for (const [file, find, replace] of isFull ? faults : some) {
    gpuTest(`a fault is noticed: ${replace}`, { tags: 'deeper' }, async () => {
      const pipelines = new Pipelines(gpu.device, { file, find, replace });
      const cells = await cellsOf(randomSplats({ count: 600, shDegree: 0 }), 'f32', { pipelines });
      expect(() => {
        for (const cell of cells) expectMerged(cell);
      }).toThrow();
    });
  }
});
