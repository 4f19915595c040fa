import type { BrickScene } from '../../data/bricks/brick.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import type { DispatchContext } from '../ingest/dispatches.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import { BrickPool, type PoolSlots, slotBytes } from './brick-pool.ts';
import { BrickStream } from './brick-stream.ts';

/** GPU memory that a scene takes where nothing else is asked for. */
export const DEFAULT_STREAM_BYTES = 512 << 20;
const { CELL_CHILDREN } = LEVEL_CONSTANTS;
/** Part of a pool for bricks above the lowest level: of a part of a scene more than a sixteenth is there. */
const UPPER_PART = 1 / 6;

export interface StreamOptions {
  /** GPU memory for the scene, at most; default 512 MiB. Scenes that need less take less. */
  readonly budgetBytes?: number;
  readonly signal?: AbortSignal;
}

/**
 * Makes a cloud that shows what views need of a scene. Resolves when its coarsest part is there.
 *
 * @throws InvalidArgumentError for a budget that does not hold a brick of each level; GpuLimitError
 *   if there is no memory; what `scene.read` throws. Nothing is left then.
 */
export async function streamScene(
  context: DispatchContext,
  scene: BrickScene,
  { budgetBytes = DEFAULT_STREAM_BYTES, signal }: StreamOptions,
  options: Pick<SplatCloudOptions, 'onDestroyed'>,
): Promise<SplatCloud> {
  const making = BrickPool.make(context, scene, slotsFor(scene, budgetBytes));
  const brick = await scene.read(scene.root, signal).catch(async (error) => {
    const pool = await making.catch(() => null);
    pool?.destroy();
    throw error;
  });
  const pool = await making;
  try {
    signal?.throwIfAborted();
    const root = pool.place(brick, scene.root, null);
    const cloud = pool.cloud(options);
    cloud.stream = new BrickStream(scene, pool, root);
    return cloud;
  } catch (error) {
    pool.destroy();
    throw error;
  }
}

/** Room for all of a scene, or as much as the budget holds. @throws InvalidArgumentError */
export function slotsFor(scene: BrickScene, budgetBytes: number): PoolSlots {
  const bytes = slotBytes(scene.shDegree);
  const chunks = chunkCountOf(scene.splatCount);
  const lowest = Math.ceil(chunks / CELL_CHILDREN);
  const upper = Math.max(1, scene.brickCount - lowest);
  if (lowest * bytes.lowest + upper * bytes.upper <= budgetBytes) return { lowest, upper };
  // From the root down to the lowest level, one brick of each, and one that may take its place.
  const levels = Math.ceil(Math.log(chunks) / Math.log(CELL_CHILDREN)) + 1;
  const least = 2 * bytes.lowest + levels * bytes.upper;
  if (budgetBytes < least) {
    const message = `budgetBytes is ${budgetBytes}; ${scene.name} needs at least ${least}.`;
    throw new InvalidArgumentError('budgetBytes', message);
  }
  const ofUpper = Math.min(upper, Math.max(levels, Math.floor((UPPER_PART * budgetBytes) / bytes.upper)));
  return { lowest: Math.floor((budgetBytes - ofUpper * bytes.upper) / bytes.lowest), upper: ofUpper };
}
