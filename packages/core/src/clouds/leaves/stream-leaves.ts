import type { LeafScene, SplatCells } from '../../data/bricks/leaf-scene.ts';
import { inLanes } from '../../data/in-lanes.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { emptyBounds } from '../../data/packing/center-bounds.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { type Bounds, boundsStep, movedBounds, robustBounds } from '../../data/packing/packed-cloud.ts';
import { MOST_REQUESTS } from '../../io/sources/few-requests.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import { chunkBytes, mergeStages } from '../stream/chunk-pages.ts';
import { streamInto } from '../stream/scene-pool.ts';
import { checkBudget, type StreamContext, type StreamOptions } from '../stream/stream-budget.ts';
import { firstBatch, LeafParts } from './leaf-parts.ts';
import { LeafPool } from './leaf-pool.ts';

export { FIRST_STAGES } from '../stream/chunk-pages.ts';

/**
 * Batches of one file that are packed at a time, enough for four workers: the first picture waits for
 * them.
 */
const PACKED_AT_ONCE = 16;
/** Memory of a pool besides its chunks, as a number of chunks. */
const OTHER_CHUNKS = 4;

/**
 * Makes a cloud that streams the leaves of a scene that views need. Resolves when the coarsest
 * level of each leaf is on the GPU.
 *
 * @throws InvalidArgumentError if the budget does not hold these levels; GpuLimitError if the
 *   device lacks memory; errors of `scene.read`. Nothing is left allocated then.
 */
export async function streamLeaves(
  context: StreamContext,
  scene: LeafScene,
  options: StreamOptions,
  { onDestroyed }: Pick<SplatCloudOptions, 'onDestroyed'>,
): Promise<SplatCloud> {
  const { least, most } = chunksFor(scene);
  const bytes = chunkBytes(scene.shDegree);
  const [leastBytes, mostBytes] = [least, most].map((chunks) => (chunks + OTHER_CHUNKS) * bytes);
  const need = { name: scene.name, leastBytes, mostBytes };
  const chunksIn = (bytesOfAll: number) =>
    Math.max(least, Math.min(most, Math.floor(bytesOfAll / bytes) - OTHER_CHUNKS));
  checkBudget(need, options);
  // Compiled while the splats are fetched; if that fails, making the pool reports the error.
  context.pipelines.prepare(mergeStages(scene.shDegree).chunks).catch(() => {});
  const coarsest = await readCoarsest(scene, options.signal);
  const shown = { ...scene, ...boundsOf(scene, coarsest) };
  // The pool starts with the least room, and grows as views need more levels.
  const shape = { chunkCells: Math.max(1, most), firstChunks: Math.max(1, least) };
  const makePool = () => LeafPool.make(context, shown, shape);
  const begin = (pool: LeafPool, bytesOfAll: number) => {
    const placed = coarsest.map((pieces, i) =>
      pieces.map((piece) => pool.place(piece, scene.leaves[i].levels.length - 1)),
    );
    const parts = new LeafParts(scene, pool, bytesOfAll, chunksIn, placed);
    pool.merge();
    return parts;
  };
  return streamInto(context, need, { ...options, onDestroyed }, makePool, begin);
}

/**
 * `least`: chunks for the coarsest level of each leaf. `most`: room for its largest other level
 * too.
 */
function chunksFor({ leaves, mostChunks }: LeafScene): { readonly least: number; readonly most: number } {
  const sum = (chunksOf: (counts: readonly number[]) => number) =>
    leaves.reduce((total, { levels }) => total + chunksOf(levels.map(({ chunkCount }) => chunkCount)), 0);
  const least = sum((counts) => counts.at(-1)!);
  return {
    least,
    most: mostChunks ?? least + sum((counts) => counts.slice(0, -1).reduce((a, b) => Math.max(a, b), 0)),
  };
}

async function readCoarsest(scene: LeafScene, signal: AbortSignal | undefined): Promise<SplatCells[][]> {
  const leavesOf = new Map<number, number[]>();
  for (const [i, { levels }] of scene.leaves.entries()) {
    const { file } = levels.at(-1)!;
    const others = leavesOf.get(file);
    if (others) others.push(i);
    else leavesOf.set(file, [i]);
  }
  const coarsest: SplatCells[][] = [];
  const coarsestOf = (i: number) => scene.leaves[i].levels.at(-1)!;
  await inLanes(MOST_REQUESTS, [...leavesOf], async ([file, inside], stop) => {
    const stopSignal = signal ? AbortSignal.any([signal, stop]) : stop;
    const fetched = await scene.read(file, stopSignal);
    const batches = batchesOf(inside, (i) => coarsestOf(i).count);
    await inLanes(PACKED_AT_ONCE, batches, async (batch) => {
      const parts = batch.map((i) => ({ leaf: scene.leaves[i], level: coarsestOf(i) }));
      for (const [at, pieces] of (await fetched.pack(parts, stopSignal)).entries())
        coarsest[batch[at]] = pieces;
    });
  });
  return coarsest;
}

/** Divides leaves into batches that are packed by one call. */
function batchesOf(leaves: readonly number[], splatsOf: (leaf: number) => number): (readonly number[])[] {
  const batches: (readonly number[])[] = [];
  for (let from = 0; from < leaves.length; from += batches.at(-1)!.length)
    batches.push(firstBatch(leaves.slice(from), splatsOf));
  return batches;
}

/** Bounds from the tree and from the coarsest splats. */
function boundsOf(
  { leaves, origin }: LeafScene,
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
  const bounds = movedBounds({ min, max }, origin);
  if (pieces.length === 0) return { bounds, robustBounds: bounds };
  return { bounds, robustBounds: robustBounds(samplesOf(pieces), origin) };
}

/** Centres of splats spread evenly over the pieces, by axis. */
function samplesOf(pieces: readonly SplatCells[]): Float32Array[] {
  const counts = pieces.map(({ cells }) => CHUNK_SPLATS * (cells.length - 1) + cells.at(-1)!.leafCount);
  const step = boundsStep(counts.reduce((sum, count) => sum + count, 0));
  const axes: number[][] = [[], [], []];
  let skipped = 0;
  for (const [i, { geometry }] of pieces.entries()) {
    const positions = new Float32Array(geometry.buffer, geometry.byteOffset);
    let splat = skipped;
    for (; splat < counts[i]; splat += step)
      for (let axis = 0; axis < 3; axis++) axes[axis].push(positions[GEOMETRY_WORDS.packed * splat + axis]);
    skipped = splat - counts[i];
  }
  return axes.map((values) => Float32Array.from(values));
}
