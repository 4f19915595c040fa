import { InvalidArgumentError } from '../../data/errors.ts';
import type { Turns } from '../../data/turns.ts';
import type { ColliderGrid, GridPlan } from './collider-grid.ts';

/** An indexed triangle mesh. */
export interface Triangles {
  /** x, y and z per vertex. */
  readonly positions: Float32Array;
  /** Three vertices per triangle, counterclockwise from outside. */
  readonly indices: Uint32Array;
}

/** Most triangles: 100 MB with their vertices, more than physics engines can use. */
const MAX_COLLIDER_TRIANGLES = 1 << 22;

/** A growable array of numbers. */
class Growing<Values extends Float32Array | Uint32Array> {
  #values: Values;
  length = 0;

  constructor(values: Values) {
    this.#values = values;
  }

  push(a: number, b: number, c: number): void {
    if (this.length + 3 > this.#values.length) {
      const Larger = this.#values.constructor as new (length: number) => Values;
      const larger = new Larger(2 * this.#values.length);
      larger.set(this.#values);
      this.#values = larger;
    }
    this.#values[this.length++] = a;
    this.#values[this.length++] = b;
    this.#values[this.length++] = c;
  }

  get taken(): Values {
    return this.#values.slice(0, this.length) as Values;
  }
}

/** The twelve edges of a cell as pairs of corners. Bits of a corner: 0 is x, 1 is y, 2 is z. */
const EDGES = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((corner) =>
  [1, 2, 4].filter((bit) => (corner & bit) === 0).map((bit) => [corner, corner | bit] as const),
);

/**
 * Returns the isosurface of the grid at opacity `solidAt` (surface nets, Gibson 1998). Each cell
 * that the surface crosses gets a vertex, at the mean of its crossings with the cell's edges. Each
 * crossed edge between nodes gets a quad.
 *
 * @param origin origin of the geometry, added to the vertices.
 * @throws InvalidArgumentError for more than 4,194,304 triangles; the reason of the turns' signal.
 */
export async function surfaceOf(
  { plan, depths }: ColliderGrid,
  solidAt: number,
  origin: readonly number[],
  turns: Turns,
): Promise<Triangles> {
  const { start, size, cellSize } = plan;
  const [nx, ny, nz] = size;
  const positions = new Growing(new Float32Array(3 << 10));
  const indices = new Growing(new Uint32Array(3 << 10));
  /** Vertex index per cell, for the current slab and the one below. */
  const slabs = [new Int32Array(nx * ny), new Int32Array(nx * ny)];
  const steps = [1, nx, nx * ny] as const;
  const cornerSteps = Array.from(
    { length: 8 },
    (_, corner) => (corner & 1) * steps[0] + ((corner >> 1) & 1) * steps[1] + (corner >> 2) * steps[2],
  );
  const opacities = new Float64Array(8);
  const solidDepth = -Math.log(1 - solidAt);
  const quad = (a: number, b: number, c: number, d: number, isForward: boolean) => {
    if (isForward) {
      indices.push(a, b, c);
      indices.push(a, c, d);
    } else {
      indices.push(a, c, b);
      indices.push(a, d, c);
    }
  };

  for (let z = 0; z < nz - 1; z++) {
    await turns.give();
    checkTriangles(indices.length / 3, plan);
    const here = slabs[z & 1];
    const below = slabs[(z + 1) & 1];
    for (let y = 0; y < ny - 1; y++) {
      for (let x = 0; x < nx - 1; x++) {
        const cell = y * nx + x;
        const node = z * steps[2] + cell;
        let solids = 0;
        for (let corner = 0; corner < 8; corner++) {
          if (depths[node + cornerSteps[corner]] >= solidDepth) solids |= 1 << corner;
        }
        if (solids === 0 || solids === 255) continue;
        for (let corner = 0; corner < 8; corner++)
          opacities[corner] = 1 - Math.exp(-depths[node + cornerSteps[corner]]);
        const [vx, vy, vz] = middleOfCrossings(opacities, solids, solidAt);
        here[cell] = positions.length / 3;
        positions.push(
          origin[0] + start[0] + cellSize * (x + vx),
          origin[1] + start[1] + cellSize * (y + vy),
          origin[2] + start[2] + cellSize * (z + vz),
        );
        const isSolid = (solids & 1) !== 0;
        // The edges that start at this node. Four cells surround each edge; this cell is the last
        // of them.
        const ends = isSolid ? ~solids : solids;
        if (ends & 2) quad(below[cell - nx], below[cell], here[cell], here[cell - nx], isSolid);
        if (ends & 4) quad(below[cell - 1], here[cell - 1], here[cell], below[cell], isSolid);
        if (ends & 16) quad(here[cell - nx - 1], here[cell - nx], here[cell], here[cell - 1], isSolid);
      }
    }
  }
  checkTriangles(indices.length / 3, plan);
  return { positions: positions.taken, indices: indices.taken };
}

function checkTriangles(count: number, { cellSize }: GridPlan): void {
  if (count <= MAX_COLLIDER_TRIANGLES) return;
  const message = `Cells of ${cellSize} make more than ${MAX_COLLIDER_TRIANGLES} triangles. Make them larger.`;
  throw new InvalidArgumentError('cellSize', message);
}

/** Mean of the points at which the surface crosses a cell's edges, 0…1 along each axis. */
function middleOfCrossings(
  opacities: Float64Array,
  solids: number,
  solidAt: number,
): readonly [number, number, number] {
  let [x, y, z, count] = [0, 0, 0, 0];
  for (const [from, to] of EDGES) {
    if (((solids >> from) & 1) === ((solids >> to) & 1)) continue;
    const part = (solidAt - opacities[from]) / (opacities[to] - opacities[from]);
    const axis = from ^ to;
    x += (from & 1) + (axis === 1 ? part : 0);
    y += ((from >> 1) & 1) + (axis === 2 ? part : 0);
    z += (from >> 2) + (axis === 4 ? part : 0);
    count++;
  }
  return [x / count, y / count, z / count];
}

/** Removes connected parts of fewer than `fewest` triangles: isolated floating splats. */
export function withoutIslands({ positions, indices }: Triangles, fewest: number): Triangles {
  const vertexCount = positions.length / 3;
  /** Union-find: the parent of each vertex; a root is its own parent. */
  const parents = Int32Array.from({ length: vertexCount }, (_, i) => i);
  const partOf = (vertex: number) => {
    let at = vertex;
    while (parents[at] !== at) {
      parents[at] = parents[parents[at]];
      at = parents[at];
    }
    return at;
  };
  for (let i = 0; i < indices.length; i += 3) {
    const part = partOf(indices[i]);
    parents[partOf(indices[i + 1])] = part;
    parents[partOf(indices[i + 2])] = part;
  }
  const sizes = new Int32Array(vertexCount);
  for (let i = 0; i < indices.length; i += 3) sizes[partOf(indices[i])]++;
  const isKept = (vertex: number) => sizes[partOf(vertex)] >= fewest;

  const numbers = new Int32Array(vertexCount);
  let kept = 0;
  for (let vertex = 0; vertex < vertexCount; vertex++) if (isKept(vertex)) numbers[vertex] = kept++;
  const keptPositions = new Float32Array(3 * kept);
  for (let vertex = 0; vertex < vertexCount; vertex++) {
    if (isKept(vertex))
      keptPositions.set(positions.subarray(3 * vertex, 3 * vertex + 3), 3 * numbers[vertex]);
  }
  const keptIndices = indices.filter((vertex) => isKept(vertex)).map((vertex) => numbers[vertex]);
  return { positions: keptPositions, indices: keptIndices };
}
