// Collisions of a walker with the mesh of a scene, y up. The reasons for this design:
//
// - The body is an upright capsule that begins a step's height above its feet. Rays from this height
//   find the ground below: lower obstacles are walked over, higher ones are walls. A capsule down to
//   the feet would stop at every bump of a mesh made from splats.
// - Walls push the capsule sideways only. Whole contact normals would lift its rounded lower end
//   over the edge of a step that is too high.
// - Contacts steeper than `FLOOR_SLOPE` belong to a floor or a ceiling and do not push: their
//   sideways part is noise. The lower end is so high that walls and ground meet at a step's height.
// - Both sides of a triangle push, away from its plane towards the capsule's axis, not along the
//   triangle's normal: where two meshes cross, normals point into each other. The axis never crosses
//   a triangle, because a substep is shorter than the radius.
// - Only upward-facing surfaces are ground. A ray that starts within a floor's thickness passes
//   through the floor's underside.
// - Triangles are as large as a cell of the mesh, so a list per column of two cells is short. A tree
//   would take longer to build than it would save.
import type { Bounds } from '@websplatter/core';
import { add, clamp, dot, scale, subtract, type Vec3 } from '../state/vec3.ts';

/** Contacts steeper than this rise over run belong to a floor or a ceiling. */
const FLOOR_SLOPE = 2;
/**
 * The end of the capsule pushes sideways only above this fraction of its radius below its centre.
 */
export const PUSHING_PART = FLOOR_SLOPE / Math.hypot(1, FLOOR_SLOPE);
/** Passes over all pushing walls, for corners. */
const ROUNDS = 6;
/** Pushes shorter than this fraction of the radius are ignored. */
const LEAST_PUSH = 1e-3;

/** Triangles, counterclockwise as seen from outside. */
export interface Surface {
  /** x, y and z of each vertex. */
  readonly positions: ArrayLike<number>;
  readonly indices: ArrayLike<number> & Iterable<number>;
}

/** The solid surface of a scene, as triangles in a grid of columns. */
export class Ground {
  /** Bounding box of all triangles. */
  readonly bounds: Bounds;
  readonly #surface: Surface;
  readonly #side: number;
  readonly #columns: readonly [x: number, z: number];
  /** Start of each column in `#inColumns`. */
  readonly #starts: Uint32Array;
  /** First index of each triangle, sorted by column. */
  readonly #inColumns: Uint32Array;

  /** @param side length of a column's side, in the units of `surface`. */
  constructor(surface: Surface, side: number) {
    this.#surface = surface;
    this.#side = side;
    const { positions, indices } = surface;
    const [min, max] = [
      [Infinity, Infinity, Infinity],
      [-Infinity, -Infinity, -Infinity],
    ] as [[number, number, number], [number, number, number]];
    for (const vertex of indices)
      for (let axis = 0; axis < 3; axis++) {
        min[axis] = Math.min(min[axis], positions[3 * vertex + axis]);
        max[axis] = Math.max(max[axis], positions[3 * vertex + axis]);
      }
    this.bounds = { min, max };
    const along = (axis: number) => (max[axis] > min[axis] ? Math.ceil((max[axis] - min[axis]) / side) : 1);
    this.#columns = [along(0), along(2)];
    this.#starts = new Uint32Array(this.#columns[0] * this.#columns[1] + 1);
    // A counting sort: `starts` holds the counts first.
    for (let i = 0; i < indices.length; i += 3)
      this.#eachColumn(...this.#footprint(i), (column) => this.#starts[column + 1]++);
    for (let i = 1; i < this.#starts.length; i++) this.#starts[i] += this.#starts[i - 1];
    this.#inColumns = new Uint32Array(this.#starts[this.#starts.length - 1]);
    const ends = this.#starts.slice();
    for (let i = 0; i < indices.length; i += 3)
      this.#eachColumn(...this.#footprint(i), (column) => {
        this.#inColumns[ends[column]++] = i;
      });
  }

  /**
   * Height of the highest upward-facing surface at `x`, `z` that is not above `y`; null if none.
   */
  below(x: number, y: number, z: number): number | null {
    return this.#nextSurface(x, y, z, 1);
  }

  /**
   * Height of the lowest downward-facing surface at `x`, `z` that is not below `y`; null if none.
   */
  above(x: number, y: number, z: number): number | null {
    return this.#nextSurface(x, y, z, -1);
  }

  #nextSurface(x: number, y: number, z: number, facing: 1 | -1): number | null {
    let found: number | null = null;
    this.#eachColumn(x, z, x, z, (column) => {
      for (let at = this.#starts[column]; at < this.#starts[column + 1]; at++) {
        const [a, b, c] = this.#corners(this.#inColumns[at]);
        const whole = facing * areaFromAbove(a, b, c);
        if (!(whole > 0)) continue;
        const point: Vec3 = [x, 0, z];
        const partA = (facing * areaFromAbove(point, b, c)) / whole;
        const partB = (facing * areaFromAbove(a, point, c)) / whole;
        const partC = 1 - partA - partB;
        // The tolerance lets a ray through an edge hit at least one triangle.
        if (Math.min(partA, partB, partC) < -1e-9) continue;
        const height = partA * a[1] + partB * b[1] + partC * c[1];
        if (facing * height <= facing * y && (found === null || facing * height > facing * found))
          found = height;
      }
    });
    return found;
  }

  /**
   * The position nearest to `x`, `z` at which an upright capsule is clear of all walls. `low` and
   * `high` are the heights of the centres of its ends. Null if the walls leave no room.
   */
  cleared(
    x: number,
    z: number,
    low: number,
    high: number,
    radius: number,
  ): readonly [x: number, z: number] | null {
    let [clearX, clearZ] = [x, z];
    for (let round = 0; round < ROUNDS; round++) {
      let longest = 0;
      const [atX, atZ] = [clearX, clearZ];
      this.#eachColumn(atX - radius, atZ - radius, atX + radius, atZ + radius, (column) => {
        for (let at = this.#starts[column]; at < this.#starts[column + 1]; at++) {
          const triangle = this.#corners(this.#inColumns[at]);
          const [a, b, c] = triangle;
          const [bottom, top] = [Math.min(a[1], b[1], c[1]), Math.max(a[1], b[1], c[1])];
          if (top < low - radius || bottom > high + radius) continue;
          // Alternates between the nearest points of triangle and axis: two rounds suffice for
          // small triangles.
          const first = nearestOn(triangle, [clearX, clamp((bottom + top) / 2, low, high), clearZ]);
          const axisY = clamp(first[1], low, high);
          const nearest = nearestOn(triangle, [clearX, axisY, clearZ]);
          const [byX, rise, byZ] = [clearX - nearest[0], axisY - nearest[1], clearZ - nearest[2]];
          const run = Math.hypot(byX, byZ);
          if (run === 0 || Math.hypot(run, rise) >= radius || Math.abs(rise) > FLOOR_SLOPE * run) continue;
          const push = Math.sqrt(radius ** 2 - rise ** 2) - run;
          clearX += (push * byX) / run;
          clearZ += (push * byZ) / run;
          longest = Math.max(longest, push);
        }
      });
      if (longest < LEAST_PUSH * radius) return [clearX, clearZ];
    }
    return null;
  }

  #corners(first: number): readonly [Vec3, Vec3, Vec3] {
    const { positions, indices } = this.#surface;
    const corner = (i: number): Vec3 => {
      const at = 3 * indices[i];
      return [positions[at], positions[at + 1], positions[at + 2]];
    };
    return [corner(first), corner(first + 1), corner(first + 2)];
  }

  #footprint(first: number): [minX: number, minZ: number, maxX: number, maxZ: number] {
    const { positions: at, indices } = this.#surface;
    const [a, b, c] = [3 * indices[first], 3 * indices[first + 1], 3 * indices[first + 2]];
    return [
      Math.min(at[a], at[b], at[c]),
      Math.min(at[a + 2], at[b + 2], at[c + 2]),
      Math.max(at[a], at[b], at[c]),
      Math.max(at[a + 2], at[b + 2], at[c + 2]),
    ];
  }

  #eachColumn(minX: number, minZ: number, maxX: number, maxZ: number, visit: (column: number) => void): void {
    const [countX, countZ] = this.#columns;
    const { min, max } = this.bounds;
    if (maxX < min[0] || minX > max[0] || maxZ < min[2] || minZ > max[2]) return;
    const column = (value: number, axis: 0 | 2, count: number) =>
      clamp(Math.floor((value - min[axis]) / this.#side), 0, count - 1);
    const lastX = column(maxX, 0, countX);
    const lastZ = column(maxZ, 2, countZ);
    for (let z = column(minZ, 2, countZ); z <= lastZ; z++)
      for (let x = column(minX, 0, countX); x <= lastX; x++) visit(z * countX + x);
  }
}

/** Twice the signed area of a triangle seen from above, positive if it is counterclockwise. */
function areaFromAbove(a: Vec3, b: Vec3, c: Vec3): number {
  return (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
}

/**
 * The point of a triangle that is nearest to `p` (Ericson, Real-Time Collision Detection, 5.1.5).
 */
function nearestOn([a, b, c]: readonly [Vec3, Vec3, Vec3], p: Vec3): Vec3 {
  const [ab, ac, ap, bp, cp] = [
    subtract(b, a),
    subtract(c, a),
    subtract(p, a),
    subtract(p, b),
    subtract(p, c),
  ];
  const [d1, d2] = [dot(ab, ap), dot(ac, ap)];
  if (d1 <= 0 && d2 <= 0) return a;
  const [d3, d4] = [dot(ab, bp), dot(ac, bp)];
  if (d3 >= 0 && d4 <= d3) return b;
  const [d5, d6] = [dot(ab, cp), dot(ac, cp)];
  if (d6 >= 0 && d5 <= d6) return c;
  const areaC = d1 * d4 - d3 * d2;
  if (areaC <= 0 && d1 >= 0 && d3 <= 0) return add(a, scale(ab, d1 / (d1 - d3)));
  const areaB = d5 * d2 - d1 * d6;
  if (areaB <= 0 && d2 >= 0 && d6 <= 0) return add(a, scale(ac, d2 / (d2 - d6)));
  const areaA = d3 * d6 - d5 * d4;
  const [fromB, fromC] = [d4 - d3, d5 - d6];
  if (areaA <= 0 && fromB >= 0 && fromC >= 0) return add(b, scale(subtract(c, b), fromB / (fromB + fromC)));
  const whole = areaA + areaB + areaC;
  return add(a, add(scale(ab, areaB / whole), scale(ac, areaC / whole)));
}
