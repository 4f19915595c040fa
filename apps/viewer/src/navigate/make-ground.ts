import type { Bounds, CloudInstance, SplatCloud } from '@websplatter/core';
import { makeColliderMesh } from '@websplatter/core/collider';
import { flippedPoint } from '../camera/flip.ts';
import { cornersOf, transformedPoint } from '../camera/scene-bounds.ts';
import { type Crop, isKept } from '../state/inspecting.ts';
import { add, cross, dot, scale, subtract, type Vec3 } from '../state/vec3.ts';
import { Ground, type Surface } from './ground.ts';

/** Cells are about a tenth of a metre: doors stay open and steps remain steps. */
const CELLS_PER_EYE_HEIGHT = 16;
/** Most cells of a mesh: a few seconds of work, and 32 MiB of the worker's memory. */
const MOST_CELLS = 2 ** 23;
const COLUMN_CELLS = 2;
/**
 * Extent of the ground around the start of a walk, in eye heights. The sky and the far background
 * of a capture would make the cells coarse. A walk may start far above the ground.
 */
export const REACH = { sideways: 24, up: 5, down: 100 } as const;

/** World-space axes of the walk's space, in which y is up. */
export interface WalkAxes {
  readonly right: Vec3;
  readonly above: Vec3;
  readonly back: Vec3;
}

export const toWalk = ({ right, above, back }: WalkAxes, point: Vec3): Vec3 => [
  dot(right, point),
  dot(above, point),
  dot(back, point),
];

export const fromWalk = ({ right, above, back }: WalkAxes, [x, y, z]: Vec3): Vec3 =>
  add(add(scale(right, x), scale(above, y)), scale(back, z));

export interface GroundOptions {
  readonly clouds: readonly CloudInstance[];
  readonly isFlipped: boolean;
  readonly crop: Crop | null;
  readonly axes: WalkAxes;
  /** Approximate start of the walk, in the walk's space. */
  readonly around: Vec3;
  /** In scene units. */
  readonly eyeHeight: number;
  readonly signal: AbortSignal;
  /** Called with the fraction done, 0…1. */
  readonly onProgress: (part: number) => void;
}

/**
 * Builds the ground of a scene, in workers. Null if nothing is solid.
 *
 * @throws as `makeColliderMesh`.
 */
export async function makeGround(options: GroundOptions): Promise<Ground | null> {
  const { clouds, eyeHeight, signal, onProgress } = options;
  const surface = { positions: [], indices: [] };
  let side = 0;
  for (const [i, { cloud, modelMatrix }] of clouds.entries()) {
    const matrix = modelMatrix ?? IDENTITY;
    const size = Math.cbrt(Math.abs(determinantOf(matrix)));
    const grid = gridFor(cloud, reachOf(matrix, options), eyeHeight / size);
    if (!grid) continue;
    const mesh = await makeColliderMesh(cloud, {
      ...grid,
      signal,
      onProgress: (part) => onProgress((i + part) / clouds.length),
    });
    side = Math.max(side, COLUMN_CELLS * grid.cellSize * size);
    addMesh(mesh, matrix, options, surface);
  }
  return surface.indices.length > 0 ? new Ground(surface, side) : null;
}

/**
 * The grid for a cloud's mesh, limited to the part within reach. Robust bounds leave out some
 * splats, which may belong to the floor: a person's height is added.
 */
function gridFor(
  { bounds, robustBounds }: SplatCloud,
  reach: Bounds,
  eyeHeight: number,
): { cellSize: number; bounds: Bounds } | null {
  const end = (axis: number): readonly [number, number] => [
    Math.max(bounds.min[axis], robustBounds.min[axis] - eyeHeight, reach.min[axis]),
    Math.min(bounds.max[axis], robustBounds.max[axis] + eyeHeight, reach.max[axis]),
  ];
  const [x, y, z] = [end(0), end(1), end(2)];
  let cellSize = eyeHeight / CELLS_PER_EYE_HEIGHT;
  const cells = () =>
    [x, y, z].reduce((product, [low, high]) => product * (Math.max(0, high - low) / cellSize + 5), 1);
  while (cells() > MOST_CELLS) cellSize *= 1.25;
  const isEmpty = [x, y, z].some(([low, high]) => high < low);
  return isEmpty ? null : { cellSize, bounds: { min: [x[0], y[0], z[0]], max: [x[1], y[1], z[1]] } };
}

/** Bounding box, in a cloud's own space, of the region within `REACH`. */
function reachOf(matrix: ArrayLike<number>, { around, axes, eyeHeight, isFlipped }: GroundOptions): Bounds {
  const { sideways, up, down } = REACH;
  const corners = cornersOf({
    min: subtract(around, scale([sideways, down, sideways], eyeHeight)),
    max: add(around, scale([sideways, up, sideways], eyeHeight)),
  }).map((corner): Vec3 => {
    const point = fromWalk(axes, corner);
    const way = subtract(isFlipped ? flippedPoint(point) : point, [matrix[12], matrix[13], matrix[14]]);
    const own = (at: number) => {
      const column: Vec3 = [matrix[at], matrix[at + 1], matrix[at + 2]];
      // The columns of a placement are orthogonal.
      return dot(column, way) / dot(column, column);
    };
    return [own(0), own(4), own(8)];
  });
  const end = (choose: (...values: number[]) => number): Vec3 => [
    choose(...corners.map(([x]) => x)),
    choose(...corners.map(([, y]) => y)),
    choose(...corners.map(([, , z]) => z)),
  ];
  return { min: end(Math.min), max: end(Math.max) };
}

/** Appends a mesh to `surface`, in the walk's space, without the cropped parts. */
function addMesh(
  { positions, indices }: Surface,
  matrix: ArrayLike<number>,
  { isFlipped, crop, axes }: GroundOptions,
  surface: { readonly positions: number[]; readonly indices: number[] },
): void {
  const first = surface.positions.length / 3;
  const isLeft: boolean[] = [];
  for (let i = 0; i < positions.length; i += 3) {
    const point = transformedPoint(matrix, [positions[i], positions[i + 1], positions[i + 2]]);
    isLeft.push(crop === null || isKept(crop, point));
    surface.positions.push(...toWalk(axes, isFlipped ? flippedPoint(point) : point));
  }
  const isMirrored = determinantOf(matrix) < 0;
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [indices[i], indices[i + (isMirrored ? 2 : 1)], indices[i + (isMirrored ? 1 : 2)]];
    if (isLeft[a] && isLeft[b] && isLeft[c]) surface.indices.push(first + a, first + b, first + c);
  }
}

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** Determinant of the upper-left 3×3 part of a column-major 4×4 matrix. */
function determinantOf(m: ArrayLike<number>): number {
  return dot([m[0], m[1], m[2]], cross([m[4], m[5], m[6]], [m[8], m[9], m[10]]));
}
