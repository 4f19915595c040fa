import { describe, expect, test } from 'vitest';
import { cellCounts } from '../../data/layout/cell-counts.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { cellsOf } from './level-cells.ts';

const { CELL_CHILDREN, NO_CELL } = LEVEL_CONSTANTS;

describe('cellsOf', () => {
  for (const chunkCount of [1, 2, 16, 17, 300]) {
    test(`${chunkCount} chunks: each cell but the top lies in its parent, which no cell makes too large`, () => {
      const random = seededRandom(chunkCount);
      const { count, minPosition, maxPosition } = CHUNK_WORDS;
      const chunks = new Float32Array(chunkCount * count);
      for (let chunk = 0; chunk < chunkCount; chunk++) {
        const min = [0, 1, 2].map(() => 10 * random() - 5);
        chunks.set(min, chunk * count + minPosition);
        chunks.set(
          min.map((at) => at + random()),
          chunk * count + maxPosition,
        );
      }
      const counts = cellCounts(chunkCount);
      const contents = cellsOf(chunks);
      const total = counts.reduce((sum, each) => sum + each, 0);
      expect(contents.byteLength).toBe(total * LevelCell.bytes);
      const { minPosition: min, maxPosition: max, parent } = LevelCell.offsets;
      const cells = Array.from({ length: total }, (_, cell) => {
        const vector = (offset: number) =>
          Array.from(new Float32Array(contents, cell * LevelCell.bytes + offset, 3));
        const [above] = new Uint32Array(contents, cell * LevelCell.bytes + parent, 1);
        return { min: vector(min), max: vector(max), parent: above };
      });
      for (let chunk = 0; chunk < chunkCount; chunk++) {
        const at = (offset: number) => Array.from(chunks.subarray(chunk * count + offset).subarray(0, 3));
        expect(cells[chunk]).toMatchObject({ min: at(minPosition), max: at(maxPosition) });
      }
      let start = 0;
      for (const [level, each] of counts.entries()) {
        for (let i = 0; i < each; i++) {
          const above = start + each + Math.floor(i / CELL_CHILDREN);
          expect(cells[start + i].parent).toBe(level + 1 < counts.length ? above : NO_CELL);
        }
        start += each;
      }
      for (const [cell, own] of cells.entries()) {
        const children = cells.filter((each) => each.parent === cell);
        if (children.length === 0) continue;
        for (const axis of [0, 1, 2]) {
          expect(own.min[axis]).toBe(Math.min(...children.map((each) => each.min[axis])));
          expect(own.max[axis]).toBe(Math.max(...children.map((each) => each.max[axis])));
        }
      }
    });
  }
});
