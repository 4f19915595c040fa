import { describe, expect, test } from 'vitest';
import { blobOpacity, type Merged, mergedOf } from '../../reference/merged-splat.ts';
import { type ReferenceSplat, unpackSplat } from '../../reference/packing.ts';
import { type LevelNode, mergeCell, mergedCoefficients } from '../../stages/merge/merge.reference.ts';
import { paletteSplats } from '../../testing/palette-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { CHUNK_WORDS } from '../layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { setLogScales } from '../packing/chunks.ts';
import { type PackedHarmonics, readCoefficients, shWordsPerSplat } from '../packing/harmonics.ts';
import { BLOB_PRECISION } from '../packing/precision.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../splats/splat-set.ts';
import type { Brick, BrickAddress, BrickScene } from './brick.ts';
import { brickSceneOf, makeBricks } from './make-bricks.ts';

async function bricksOf(scene: BrickScene): Promise<Map<number, Brick>> {
  const bricks = new Map<number, Brick>();
  const addresses: BrickAddress[] = [scene.root];
  for (const address of addresses) {
    const brick = await scene.read(address);
    bricks.set(address.number, brick);
    for (const { child } of brick.cells) if (child) addresses.push(child);
  }
  return bricks;
}

interface Leaf {
  readonly merged: Merged;
  readonly opacity: number;
  readonly scale: ReferenceSplat['scale'];
  readonly rotation: ReferenceSplat['rotation'];
  readonly coefficients: number[];
}

/** The leaves of a cell of a brick, as they are drawn. */
function leavesOf(brick: Brick, cell: number, degree: ShDegree): Leaf[] {
  const isSplat = brick.level === 0;
  const chunks = new Float32Array(brick.cells.length * CHUNK_WORDS.count);
  for (const [i, { logScales }] of brick.cells.entries())
    setLogScales(chunks, i, { min: logScales[0], step: logScales[1] });
  const precision = isSplat ? 'packed' : 'f32';
  const wordsPerSplat = shWordsPerSplat(degree, BLOB_PRECISION.shPrecision);
  const harmonics: PackedHarmonics = { degree, precision: 'u8', wordsPerSplat, words: brick.harmonics };
  const floats = new Float32Array(brick.geometry.buffer);
  return Array.from({ length: brick.cells[cell].leafCount }, (_, i) => {
    const at = cell * CHUNK_SPLATS + i;
    const splat = unpackSplat({ precision, words: brick.geometry, chunks }, at);
    const values = new Float64Array(coefficientsPerSplat(degree));
    readCoefficients(harmonics, at, values);
    return {
      merged: mergedOf(splat, isSplat ? undefined : [floats[16 * at + 11], floats[16 * at + 15]]),
      opacity: splat.opacity,
      scale: splat.scale,
      rotation: splat.rotation,
      coefficients: Array.from(values),
    };
  });
}

function expectNear(actual: readonly number[], expected: readonly number[], tolerance: number): void {
  for (const [i, value] of actual.entries())
    if (!(Math.abs(value - expected[i]) <= tolerance)) expect.fail(`${actual} for ${expected}`);
}

/** Expects each leaf above level 0 to be a root as the reference merges the cell below. */
async function expectAsReference(scene: BrickScene): Promise<void> {
  const degree = scene.shDegree;
  for (const brick of (await bricksOf(scene)).values()) {
    if (brick.level === 0) continue;
    for (const [i, cell] of brick.cells.entries()) {
      const leaves = leavesOf(brick, i, degree);
      const child = await scene.read(cell.child!);
      expect(child.level).toBe(brick.level - 1);
      expect(child.cells.length).toBe(cell.childErrors.length);
      expect(cell.leafCount).toBe(cell.childRoots.reduce((sum, count) => sum + count, 0));
      for (const [k, below] of child.cells.entries()) {
        const own = leavesOf(child, k, degree);
        const errors = own.map((_, leaf) => below.childErrors[leaf >> 4] ?? 0);
        const { roots } = mergeCell(
          own.map(({ merged }) => merged),
          errors,
        );
        expect(cell.childRoots[k]).toBe(roots.length);
        expect(cell.childErrors[k]).toBe(Math.max(...roots.map(({ error }) => error)));
        for (const error of below.childErrors) expect(cell.childErrors[k]).toBeGreaterThanOrEqual(error);
        const coefficientsOf = ({ merged }: LevelNode) =>
          own.find((leaf) => leaf.merged === merged)!.coefficients;
        for (const [r, root] of roots.entries()) {
          const { merged, opacity, scale, rotation, coefficients } = leaves[16 * k + r];
          const size = Math.sqrt(root.merged.covariance.slice(0, 3).reduce((sum, each) => sum + each));
          expectNear(merged.center, root.merged.center, 1e-6 * Math.max(size, 1));
          expectNear(merged.covariance, root.merged.covariance, 1e-5 * size ** 2);
          expectNear(merged.color, root.merged.color, 1e-5);
          expectNear(merged.sums, root.merged.sums, 1e-6 * root.merged.sums[1]);
          expect(opacity / blobOpacity(root.merged, { scale, rotation })).toBeCloseTo(1, 4);
          const expected = mergedCoefficients(root, coefficientsOf);
          const largest = Math.max(...expected.map(Math.abs), 0);
          expectNear(coefficients, expected, 0.6 * (largest / 127));
          for (let axis = 0; axis < 3; axis++) {
            expect(merged.center[axis]).toBeGreaterThanOrEqual(below.bounds.min[axis]);
            expect(merged.center[axis]).toBeLessThanOrEqual(below.bounds.max[axis]);
          }
        }
      }
    }
  }
}

describe('brickSceneOf', () => {
  test.each([
    [4200, 3],
    [4100, 0],
    [257, 2],
  ] as const)('%d splats of degree %d: leaves are the roots of the reference', async (count, shDegree) => {
    await expectAsReference(brickSceneOf(randomSplats({ count, shDegree, seed: count })));
  });

  const hard: Record<string, (set: SplatSet, i: number) => void> = {
    needles: ({ logScales }, i) => logScales.set([-1, -9, -9], 3 * i),
    'splats of one place, size and colour': ({ positions, logScales, colorDc }, i) => {
      positions.set([1, 2, 3], 3 * i);
      logScales.set([-3, -3, -3], 3 * i);
      colorDc.set([0, 0, 0], 3 * i);
    },
    'opaque splats on top of each other': ({ positions, logScales, opacityLogits }, i) => {
      positions.set([1, 2, 3], 3 * i);
      logScales.set([-3, -3, -3], 3 * i);
      opacityLogits[i] = 80;
    },
  };
  test.each(Object.entries(hard))('%s: as in the reference', async (_, change) => {
    const set = randomSplats({ count: 600, seed: 3, shDegree: 0 });
    for (let i = 0; i < set.count; i++) change(set, i);
    await expectAsReference(brickSceneOf(set));
  });

  test('has every splat once, and each cell within the one above', async () => {
    const set = randomSplats({ count: 70_000, shDegree: 0 });
    const scene = brickSceneOf(set, { name: 'cube' });
    expect(scene).toMatchObject({ name: 'cube', splatCount: 70_000, shDegree: 0, origin: [0, 0, 0] });
    const bricks = await bricksOf(scene);
    expect([...bricks.keys()]).toEqual(Array.from({ length: scene.brickCount }, (_, i) => i));
    // 274 chunks, 18 cells above them, and so on: the root, and as many bricks as cells above chunks.
    expect(scene.brickCount).toBe(1 + 18 + 2 + 1);
    const rows = new Uint8Array(set.count);
    for (const brick of bricks.values()) {
      const count = brick.cells.length * CHUNK_SPLATS;
      expect(brick.geometry.length).toBe(count * (brick.level === 0 ? 8 : 16));
      expect(brick.harmonics.length).toBe(0);
      expect(brick.fileIndices.length).toBe(brick.level === 0 ? count : 0);
      for (const [i, cell] of brick.cells.entries()) {
        if (brick.level === 0) {
          for (let k = 0; k < cell.leafCount; k++) rows[brick.fileIndices[CHUNK_SPLATS * i + k]]++;
          continue;
        }
        expect(cell.logScales).toEqual([0, 0]);
        for (const { bounds } of bricks.get(cell.child!.number)!.cells) {
          for (let axis = 0; axis < 3; axis++) {
            expect(bounds.min[axis]).toBeGreaterThanOrEqual(cell.bounds.min[axis]);
            expect(bounds.max[axis]).toBeLessThanOrEqual(cell.bounds.max[axis]);
          }
        }
      }
    }
    expect(rows.every((times) => times === 1)).toBe(true);
  });

  test('few splats are the root; a palette becomes bytes', async () => {
    const set = paletteSplats({ count: 20, entryCount: 5 });
    const scene = brickSceneOf(set);
    expect(scene.brickCount).toBe(1);
    const root = await scene.read(scene.root);
    expect(root).toMatchObject({ level: 0, cells: [{ leafCount: 20, child: null, childErrors: [] }] });
    const expected = new Float64Array(45);
    for (const [i, { coefficients }] of leavesOf(root, 0, 3).entries()) {
      readCoefficients(set.harmonics, root.fileIndices[i], expected);
      expectNear(coefficients, [...expected], 0.6 * (Math.max(...expected.map(Math.abs)) / 127));
    }
    expect(root.geometry.subarray(20 * 8).every((word) => word === 0)).toBe(true);
  });

  test('refuses what it cannot divide', async () => {
    expect(() => makeBricks(randomSplats({ count: 0 }))).toThrow('There are no splats');
    const set = randomSplats({ count: 5 });
    set.positions[7] = Number.NaN;
    expect(() => makeBricks(set)).toThrow('1 of 5 splats have values that are not finite');
    const scene = brickSceneOf(randomSplats({ count: 5 }));
    await expect(scene.read({ number: 1, offset: 0, bytes: 0 })).rejects.toThrow('address.number is 1');
    await expect(scene.read(scene.root, AbortSignal.abort('stop'))).rejects.toBe('stop');
  });
});
