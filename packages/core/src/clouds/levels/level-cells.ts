import { cellCounts } from '../../data/layout/cell-counts.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';

const { CELL_CHILDREN, NO_CELL } = LEVEL_CONSTANTS;

/**
 * Computes the contents of a cloud's buffer of cells from the `Chunk` structs of its chunks.
 *
 * @param others the same chunks with other bounds; cells enclose both.
 */
export function cellsOf(chunks: Float32Array, others: Float32Array = chunks): ArrayBuffer {
  const { count: words, minPosition, maxPosition } = CHUNK_WORDS;
  const counts = cellCounts(chunks.length / words);
  const total = counts.reduce((sum, count) => sum + count, 0);
  const contents = new ArrayBuffer(total * LevelCell.bytes);
  // Word by word, because objects for 25,000 cells (six million splats) take 100 ms.
  const [bounds, links] = [new Float32Array(contents), new Uint32Array(contents)];
  const stride = LevelCell.bytes / 4;
  const [min, max, parent] = (['minPosition', 'maxPosition', 'parent'] as const).map(
    (field) => LevelCell.offsets[field] / 4,
  );
  for (let chunk = 0; chunk < counts[0]; chunk++) {
    for (let axis = 0; axis < 3; axis++) {
      const [low, high] = [chunk * words + minPosition + axis, chunk * words + maxPosition + axis];
      bounds[chunk * stride + min + axis] = Math.min(chunks[low], others[low]);
      bounds[chunk * stride + max + axis] = Math.max(chunks[high], others[high]);
    }
  }
  links[(total - 1) * stride + parent] = NO_CELL;
  let start = 0;
  for (const count of counts.slice(0, -1)) {
    const next = start + count;
    for (let i = 0; i < count; i++) {
      const above = next + Math.floor(i / CELL_CHILDREN);
      const from = (start + i) * stride;
      const to = above * stride;
      links[from + parent] = above;
      const isFirst = i % CELL_CHILDREN === 0;
      for (let axis = 0; axis < 3; axis++) {
        const low = bounds[from + min + axis];
        const high = bounds[from + max + axis];
        bounds[to + min + axis] = isFirst ? low : Math.min(bounds[to + min + axis], low);
        bounds[to + max + axis] = isFirst ? high : Math.max(bounds[to + max + axis], high);
      }
    }
    start = next;
  }
  return contents;
}
