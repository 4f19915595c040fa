import { InvalidArgumentError } from '../../data/errors.ts';
import { given, SPLATS, wrongArgument } from '../../data/given.ts';
import { callListener } from '../../data/listeners.ts';
import { type Bounds, checkPacked, type PackedCloud } from '../../data/packing/packed-cloud.ts';
import { shown } from '../../data/printable.ts';
import { buildOfGeometry, checkTime } from '../build-of-geometry.ts';
import type { SplatCloud } from '../splat-cloud.ts';
import { ColliderBuilder } from './build-collider.ts';
import type { GridPlan } from './collider-grid.ts';
import type { ColliderPlan } from './collider-plan.ts';
import type { Triangles } from './collider-surface.ts';

/** Resolution and extent of a collider. */
export interface ColliderMeshOptions {
  /**
   * Length of a cell's edge in the cloud's own space. Halving it takes about eight times the work
   * and memory. Default: a ninety-sixth of the longest side of `bounds`.
   */
  readonly cellSize?: number;
  /**
   * Box to mesh in the cloud's space; the mesh is closed at its sides. Default: the cloud's
   * `robustBounds`.
   */
  readonly bounds?: Bounds;
  /** Opacity from which on a place is solid, 0…1 exclusive. Default: 0.5. */
  readonly solidAt?: number;
  /**
   * Connected parts of fewer triangles, usually isolated floating splats, are removed. Default:
   * 100.
   */
  readonly fewestTriangles?: number;
  /** Time at which the splats of a moving cloud are read, in the unit of its file; default its first. Needs `bounds`. */
  readonly time?: number;
  /** Aborts the work. */
  readonly signal?: AbortSignal;
  /** Called with the processed share of the splats, 0…1. */
  readonly onProgress?: (part: number) => void;
}

/** A coarse mesh around a cloud's opaque parts, in the cloud's own space, for physics engines. */
export interface ColliderMesh extends Triangles {
  /** Length of a cell's edge in the cloud's own space. */
  readonly cellSize: number;
}

/** Most nodes of a grid: 64 MiB. */
const MAX_COLLIDER_NODES = 1 << 24;

const DEFAULT_CELLS = 96;
const DEFAULT_SOLID_AT = 0.5;
const DEFAULT_FEWEST_TRIANGLES = 100;
/** Empty cells around the bounds, for the extents of blurred splats. */
const MARGIN_CELLS = 2;
/** Share of the progress for reading splats. */
const READING_PART = 0.9;

/**
 * Makes a coarse, closed mesh around a cloud's opaque parts, from the opacity of its splats sampled
 * on a grid. The mesh lies up to a cell outside of the visible surface, and closes openings
 * narrower than about two cells. Splats larger than half of the bounds are left out as sky. Runs in
 * a worker, or in turns on this thread if none can start. Takes 4 bytes per cell, 64 MiB at most,
 * and one piece of the splats at a time. The same cloud always gives the same mesh.
 *
 * @param splats a cloud on the GPU, whose geometry is read back piece by piece, or a packed one.
 * @returns the mesh; empty if nothing is opaque.
 * @throws InvalidArgumentError for options out of range, for a time of a moving cloud without bounds, for more than 16,777,216 cells, and for
 *   more than 4,194,304 triangles; SplatSourceError for a preview; DestroyedError if cloud, engine
 *   or device end first; GpuLimitError if the device lacks memory; WebSplatterError `worker-failed`
 *   if the worker dies; the signal's reason.
 * @example
 * const { positions, indices } = await makeColliderMesh(cloud, { cellSize: 0.1 });
 * // In Rapier, unless the mesh is empty: ColliderDesc.trimesh(positions, indices).
 */
export async function makeColliderMesh(
  splats: SplatCloud | PackedCloud,
  options: ColliderMeshOptions = {},
): Promise<ColliderMesh> {
  const { bounds, time, signal, onProgress } = given(options, {
    cellSize: 'a number?',
    bounds: 'an object?',
  });
  given(splats, SPLATS, 'splats');
  if ('geometry' in splats) checkPacked(splats);
  checkTime(time);
  // The default bounds, `robustBounds`, hold the splats before they move.
  if (time !== undefined && !bounds && ('timeRange' in splats ? splats.timeRange : splats.motion))
    throw wrongArgument('bounds', bounds, 'given with `time`');
  signal?.throwIfAborted();
  const plan = planFor(splats, options);
  const { cellSize } = plan.grid;
  if (splats.count === 0) return { positions: new Float32Array(), indices: new Uint32Array(), cellSize };
  const mesh = await buildOfGeometry(splats, {
    what: 'collider',
    subject: 'A collider',
    plan,
    // Bundlers recognise a worker only in this form, written as one expression.
    makeWorker: () => new Worker(new URL('./collider-worker.ts', import.meta.url), { type: 'module' }),
    make: () => new ColliderBuilder(plan, signal),
    time,
    signal,
    onProgress: (part) => callListener(onProgress, READING_PART * part),
  });
  callListener(onProgress, 1);
  return { ...mesh, cellSize };
}

function planFor(
  { robustBounds, origin, count }: Pick<PackedCloud, 'robustBounds' | 'origin' | 'count'>,
  {
    // Bounds of an empty cloud are inverted.
    bounds = count > 0 ? robustBounds : { min: origin, max: origin },
    cellSize,
    solidAt = DEFAULT_SOLID_AT,
    fewestTriangles = DEFAULT_FEWEST_TRIANGLES,
  }: ColliderMeshOptions,
): ColliderPlan {
  const { min, max } = bounds;
  const sides = [0, 1, 2].map((axis) => max[axis] - min[axis]);
  if (!sides.every((side) => side >= 0 && side < Number.POSITIVE_INFINITY)) {
    const found = `from ${shown(min)} to ${shown(max)}`;
    throw new InvalidArgumentError(
      'bounds',
      `The bounds are ${found}: max must be finite and no less than min.`,
    );
  }
  if (!(solidAt > 0 && solidAt < 1)) {
    throw wrongArgument('solidAt', solidAt, 'an opacity between 0 and 1');
  }
  if (!(Number.isInteger(fewestTriangles) && fewestTriangles >= 0)) {
    throw wrongArgument('fewestTriangles', fewestTriangles, 'a whole number of 0 or more');
  }
  // The bounds of a single splat have no extent.
  const longest = Math.max(...sides) || 1;
  const edge = cellSize ?? longest / DEFAULT_CELLS;
  if (!(edge > 0 && edge < Number.POSITIVE_INFINITY)) {
    throw wrongArgument('cellSize', edge, 'a length above 0');
  }
  const size = nodesAlong(sides, edge);
  if (size[0] * size[1] * size[2] > MAX_COLLIDER_NODES) {
    const message = `Cells of ${edge} in bounds of ${sides.join(' × ')} are more than ${MAX_COLLIDER_NODES}. Make them at least ${smallestCell(sides)}, or give smaller bounds.`;
    throw new InvalidArgumentError('cellSize', message);
  }
  const startAt = (axis: number) => min[axis] - origin[axis] - MARGIN_CELLS * edge;
  const grid: GridPlan = { start: [startAt(0), startAt(1), startAt(2)], size, cellSize: edge };
  return { grid, origin, solidAt, fewestTriangles };
}

function nodesAlong(sides: readonly number[], cellSize: number): [number, number, number] {
  const [x, y, z] = sides.map((side) => Math.ceil(side / cellSize) + 1 + 2 * MARGIN_CELLS);
  return [x, y, z];
}

/**
 * The smallest cell size, rounded up to two digits, that keeps the grid of these sides within its
 * limit.
 */
function smallestCell(sides: readonly number[]): number {
  let [low, high] = [0, Math.max(...sides)];
  for (let i = 0; i < 50; i++) {
    const middle = (low + high) / 2;
    const [x, y, z] = nodesAlong(sides, middle);
    if (x * y * z > MAX_COLLIDER_NODES) low = middle;
    else high = middle;
  }
  const step = 10 ** (Math.floor(Math.log10(high)) - 1);
  return Number((Math.ceil(high / step) * step).toPrecision(2));
}
