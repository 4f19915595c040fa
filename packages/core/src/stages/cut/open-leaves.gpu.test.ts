import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkLinks, LEVEL_CONSTANTS, OpenedLeaves } from '../../data/layout/level-structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { openLeaves as reference } from './cut.reference.ts';
import { openLeaves } from './cut.ts';

const gpu = testGpu();

describe('open-leaves', () => {
  const random = seededRandom(3);
  /** Leaves with parents, in all places but every fifth. */
  const leaves = Array.from({ length: CHUNK_SPLATS }, (_, i) =>
    i % 5 === 4 ? 0 : Math.floor(random() * 2 ** 32),
  );
  const errors = Array.from({ length: 16 }, (_, i) => 100 + 7 * i);
  const cases: [name: string, links: number[], errors: number[]][] = [
    ['all cells are there', leaves, errors],
    ['none is', leaves, errors.map(() => 0)],
    ['some are', leaves, errors.map((error, i) => (i % 3 === 0 ? 0 : error))],
    ['there are few leaves', leaves.map((link, i) => (i < 20 ? link : 0)), errors],
  ];
  for (const [name, links, errors] of cases) {
    gpuTest(`${name}: as the reference opens`, async () => {
      const head = [9, 8, 7, 6, 5, 0, 0, 3];
      const other = Array.from({ length: ChunkLinks.words }, (_, i) => i);
      const shifted = errors.map((error) => 2 * error);
      const upperLinks = gpu.storage([...other, ...head, ...links, ...other, ...head, ...links]);
      const parameters = gpu.uniform(openedLeaves([3, 1], [shifted, errors]));
      // More workgroups than cells, in rows of one.
      await gpu.run(openLeaves, { parameters, upperLinks }, [1, 3, 1]);
      const words = Array.from(await gpu.read(upperLinks));
      const expected = [errors, shifted].flatMap((each) => {
        const { links: opened, leastError, uncounted } = reference(links, each);
        return [...other, ...[9, 8, leastError, 6, 5, 0, 0, uncounted], ...opened];
      });
      expect(words).toEqual(expected);
    });
  }
});

/** @param errorsOf errors of the cells below each. */
function openedLeaves(ofCells: readonly number[], errorsOf: readonly (readonly number[])[]): ArrayBuffer {
  const { OPENED_CELLS, CELL_CHILDREN } = LEVEL_CONSTANTS;
  const chunks = new Uint32Array(OPENED_CELLS);
  chunks.set(ofCells);
  const errors = new Uint32Array(CELL_CHILDREN * OPENED_CELLS);
  errors.set(errorsOf.flat());
  return OpenedLeaves.pack({ chunks, errors, count: ofCells.length, dispatchRow: 1 });
}
