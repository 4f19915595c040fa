import type { Vec3 } from '../state/vec3.ts';
import { Ground } from './ground.ts';

const CELL = 0.125;

/** Ground of boxes whose faces have triangles as large as the cells of a mesh. */
export function ground(...boxes: readonly (readonly [min: Vec3, max: Vec3])[]): Ground {
  const positions: number[] = [];
  const indices: number[] = [];
  for (const [min, max] of boxes)
    for (const axis of [0, 1, 2])
      for (const end of [min, max]) {
        const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        const [countU, countV] = [u, v].map((each) => Math.ceil((max[each] - min[each]) / CELL));
        const first = positions.length / 3;
        for (let i = 0; i <= countU; i++)
          for (let j = 0; j <= countV; j++) {
            const point = [0, 0, 0];
            point[axis] = end[axis];
            point[u] = min[u] + ((max[u] - min[u]) * i) / countU;
            point[v] = min[v] + ((max[v] - min[v]) * j) / countV;
            positions.push(...point);
          }
        for (let i = 0; i < countU; i++)
          for (let j = 0; j < countV; j++) {
            const a = first + i * (countV + 1) + j;
            const [b, c, d] = [a + countV + 1, a + countV + 2, a + 1];
            indices.push(...(end === max ? [a, b, c, a, c, d] : [a, c, b, a, d, c]));
          }
      }
  return new Ground({ positions, indices: Uint32Array.from(indices) }, 2 * CELL);
}

/** Eight metres wide, with its top at 0. */
export const FLOOR = [
  [-4, -0.25, -4],
  [4, 0, 4],
] as const;
