import type { LeafScene, SplatCells } from '../../data/bricks/leaf-scene.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { inLanes } from '../../data/in-lanes.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { emptyBounds } from '../../data/packing/center-bounds.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { type Bounds, robustBounds } from '../../data/packing/packed-cloud.ts';
import { openLeaves } from '../../io/formats/sog/open-leaves.ts';
import type { ReadOptions, SplatSource } from '../../io/sources/splat-source.ts';
import { chunkBytes } from '../bricks/chunk-pages.ts';
import { DEFAULT_STREAM_BYTES, type StreamOptions } from '../bricks/stream-scene.ts';
import type { DispatchContext } from '../ingest/dispatches.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import { LeafPool } from './leaf-pool.ts';
import { FETCHED_AT_ONCE, LeafStream } from './leaf-stream.ts';

/** Chunks' worth of memory that a pool takes besides. */
const OTHER_CHUNKS = 4;

/**
 * Shows a streamed SOG: see `openLeaves` and `streamLeaves`. Null for an archive without one.
 */
export async function loadLeaves(
  context: DispatchContext,
  source: SplatSource,
  options: StreamOptions & Omit<ReadOptions, 'onProgress'>,
  cloudOptions: Pick<SplatCloudOptions, 'onDestroyed'>,
): Promise<SplatCloud | null> {
  const scene = await openLeaves(source, options);
  return scene && streamLeaves(context, scene, options, cloudOptions);
}

/**
 * Makes a cloud that shows what views need of a scene in leaves. Resolves when the coarsest level
 * of each leaf is there.
 *
 * @throws InvalidArgumentError for a budget that does not hold these; GpuLimitError if there is no
 *   memory; what `scene.read` throws. Nothing is left then.
 */
export async function streamLeaves(
  context: DispatchContext,
  scene: LeafScene,
  { budgetBytes = DEFAULT_STREAM_BYTES, signal }: StreamOptions,
  options: Pick<SplatCloudOptions, 'onDestroyed'>,
): Promise<SplatCloud> {
  const chunkCount = chunksFor(scene, budgetBytes);
  const coarsest = await readCoarsest(scene, signal);
  const pool = await LeafPool.make(context, { ...scene, ...boundsOf(scene, coarsest) }, chunkCount);
  try {
    signal?.throwIfAborted();
    const placed = coarsest.map((pieces) => pool.place(pieces));
    const cloud = pool.cloud(options);
    cloud.stream = new LeafStream(scene, pool, placed);
    return cloud;
  } catch (error) {
    pool.destroy();
    throw error;
  }
}

/** Room for all of a scene, or as much as the budget holds. @throws InvalidArgumentError */
function chunksFor({ name, shDegree, leaves }: LeafScene, budgetBytes: number): number {
  const sum = (chunksOf: (counts: readonly number[]) => number) =>
    leaves.reduce((total, { levels }) => total + chunksOf(levels.map(({ count }) => chunkCountOf(count))), 0);
  const least = sum((counts) => counts.at(-1)!);
  const most = least + sum((counts) => Math.max(0, ...counts.slice(0, -1)));
  const held = Math.floor(budgetBytes / chunkBytes(shDegree)) - OTHER_CHUNKS;
  if (held >= least) return Math.min(held, most);
  const leastBytes = (least + OTHER_CHUNKS) * chunkBytes(shDegree);
  const message = `budgetBytes is ${budgetBytes}; ${name} needs at least ${leastBytes}.`;
  throw new InvalidArgumentError('budgetBytes', message);
}

/** Reads the coarsest level of each leaf. */
async function readCoarsest(scene: LeafScene, signal: AbortSignal | undefined): Promise<SplatCells[][]> {
  const leavesOf = new Map<number, number[]>();
  for (const [i, { levels }] of scene.leaves.entries()) {
    const { file } = levels.at(-1)!;
    leavesOf.set(file, [...(leavesOf.get(file) ?? []), i]);
  }
  const coarsest: SplatCells[][] = [];
  await inLanes(FETCHED_AT_ONCE, [...leavesOf], async ([file, inside], stop) => {
    const stopSignal = signal ? AbortSignal.any([signal, stop]) : stop;
    const decoded = await scene.read(file, stopSignal);
    for (const i of inside) {
      const leaf = scene.leaves[i];
      coarsest[i] = await decoded.pieces(leaf, leaf.levels.at(-1)!, stopSignal);
    }
  });
  return coarsest;
}

/** Where a scene lies, as its tree and the coarsest splats tell. */
function boundsOf(
  { leaves }: LeafScene,
  coarsest: readonly SplatCells[][],
): { readonly bounds: Bounds; readonly robustBounds: Bounds } {
  const { min, max } = emptyBounds();
  const extend = (bounds: Bounds) => {
    for (let axis = 0; axis < 3; axis++) {
      min[axis] = Math.min(min[axis], bounds.min[axis]);
      max[axis] = Math.max(max[axis], bounds.max[axis]);
    }
  };
  for (const { bounds } of leaves) if (bounds) extend(bounds);
  const pieces = coarsest.flat();
  for (const { cells } of pieces) for (const { bounds } of cells) extend(bounds);
  const bounds = { min, max };
  if (pieces.length === 0) return { bounds, robustBounds: bounds };
  const axes = [0, 1, 2].map((axis) =>
    Float32Array.from(
      pieces.flatMap(({ cells, geometry }) => {
        const positions = new Float32Array(geometry.buffer);
        const count = CHUNK_SPLATS * (cells.length - 1) + cells.at(-1)!.leafCount;
        return Array.from({ length: count }, (_, i) => positions[GEOMETRY_WORDS.packed * i + axis]);
      }),
    ),
  );
  return { bounds, robustBounds: robustBounds(axes, [0, 0, 0]) };
}
