import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkLinks, OpenedLeaves } from '../../data/layout/level-structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { openLeaves as reference } from './cut.reference.ts';
import { openLeaves } from './cut.ts';

const HEAD_WORDS = ChunkLinks.words - CHUNK_SPLATS;
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
      const upperLinks = gpu.storage([...other, ...head, ...links]);
      const parameters = gpu.uniform(OpenedLeaves.pack({ chunk: 1, errors }));
      await gpu.run(openLeaves, { parameters, upperLinks }, [1, 1, 1]);
      const words = Array.from(await gpu.read(upperLinks));
      const expected = reference(links, errors);
      expect(words.slice(ChunkLinks.words + HEAD_WORDS)).toEqual(expected.links);
      const { leastError, uncounted } = expected;
      expect(words.slice(0, ChunkLinks.words + HEAD_WORDS)).toEqual([
        ...other,
        ...[9, 8, leastError, 6, 5, 0, 0, uncounted],
      ]);
    });
  }
});
