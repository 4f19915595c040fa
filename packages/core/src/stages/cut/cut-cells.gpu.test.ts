import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CutParameters, LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';
import { threshold } from '../../reference/level-link.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { dispatchSize } from '../dispatch.ts';
import { type CutValues, cellThreshold } from './cut.reference.ts';
import { cutCells } from './cut.ts';

const DISPATCH_ROW = 2;
const gpu = testGpu();

interface Cell {
  readonly min: number[];
  readonly max: number[];
  readonly parent: number;
}

/** Random boxes within boxes, parents first. */
function nestedCells(count: number, size: number): Cell[] {
  const random = seededRandom(count);
  const cells: Cell[] = [
    { min: [-size, -size, -size], max: [size, size, size], parent: LEVEL_CONSTANTS.NO_CELL },
  ];
  while (cells.length < count) {
    const parent = Math.floor(random() * cells.length);
    const { min, max } = cells[parent];
    const sides = min.map((low, axis) => {
      const ends = [random(), random()].map((at) => Math.fround(low + at * (max[axis] - low)));
      return [Math.max(low, Math.min(...ends)), Math.min(max[axis], Math.max(...ends))];
    });
    cells.push({ min: sides.map(([low]) => low), max: sides.map(([, high]) => high), parent });
  }
  return cells;
}

/** Thresholds of all cells for each of the cuts in turn. */
async function thresholdsOf(cells: readonly Cell[], cuts: readonly CutValues[]): Promise<Uint32Array> {
  const contents = new ArrayBuffer(cells.length * LevelCell.bytes);
  for (const [i, { min, max, parent }] of cells.entries())
    LevelCell.write(contents, { minPosition: min, maxPosition: max, parent }, i * LevelCell.bytes);
  const count = cells.length * cuts.length;
  const thresholds = gpu.storage([], 4 * count);
  const parameters = new ArrayBuffer(CutParameters.bytes * cuts.length);
  for (const [i, cut] of cuts.entries()) {
    const values = { ...cut, cellCount: cells.length, dispatchRow: DISPATCH_ROW };
    CutParameters.write(parameters, values, i * CutParameters.bytes);
  }
  const bindings = {
    cuts: gpu.uniform(parameters),
    cells: gpu.storage(new Uint32Array(contents)),
    thresholds,
  };
  await gpu.run(cutCells(cuts.length), bindings, dispatchSize(Math.ceil(count / 64), DISPATCH_ROW));
  return gpu.read(thresholds);
}

describe('cut-cells', () => {
  const perspective = { squaredPerDistance: 1e-6, leastSquared: 0, margin: 0 };
  const cuts: Record<string, CutValues> = {
    'from outside': { ...perspective, camera: [30, 1, -2] },
    'from inside': { ...perspective, camera: [0.1, 0.2, 0.3] },
    'with splats that move': { ...perspective, camera: [30, 1, -2], margin: 20 },
    'at no error': { ...perspective, squaredPerDistance: 0, camera: [30, 1, -2] },
    'from inside, with a near plane': { ...perspective, leastSquared: 1e-7, camera: [0.1, 0.2, 0.3] },
    'from very far': { ...perspective, camera: [3e30, 0, 0] },
    'of parallel rays': { camera: [0, 0, 0], squaredPerDistance: 0, leastSquared: 0.01, margin: 0 },
  };
  for (const [name, values] of Object.entries(cuts)) {
    for (const size of [1e-6, 10, 1e9]) {
      gpuTest(`${name}, ${size} units: as the reference, and no parent above its children`, async () => {
        const cells = nestedCells(1000, size);
        const thresholds = await thresholdsOf(cells, [values]);
        for (const [i, cell] of cells.entries()) {
          // Rounding of float32 may cross a step. The farthest distances are clamped.
          const expected = Math.min(
            cellThreshold(cell, values),
            cellThreshold(cell, { ...values, camera: [1e18, 0, 0] }),
          );
          if (values.camera[0] < 1e18)
            expect(Math.abs(thresholds[i] - expected), `cell ${i}`).toBeLessThanOrEqual(1);
          expect(thresholds[i]).toBeGreaterThanOrEqual(threshold(values.leastSquared));
          if (i > 0) expect(thresholds[cell.parent], `parent of ${i}`).toBeLessThanOrEqual(thresholds[i]);
        }
      });
    }
  }

  gpuTest('of several instances: those of each as by itself, one after another', async () => {
    const cells = nestedCells(150, 10);
    const all = Object.values(cuts);
    const apart = await Promise.all(all.map(async (cut) => [...(await thresholdsOf(cells, [cut]))]));
    expect([...(await thresholdsOf(cells, all))]).toEqual(apart.flat());
    expect(new Set(apart.map(String)).size).toBeGreaterThan(4);
  });
});
