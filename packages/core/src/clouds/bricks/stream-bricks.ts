import type { BrickScene } from '../../data/bricks/brick.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import { streamInto } from '../stream/make-pool.ts';
import { checkBudget, type StreamContext, type StreamOptions, withShare } from '../stream/stream-budget.ts';
import { BrickPool, type PoolSlots, poolBytes, rootStages, slotBytes } from './brick-pool.ts';
import { BrickStream } from './brick-stream.ts';

const { CELL_CHILDREN } = LEVEL_CONSTANTS;
/**
 * Share of a pool for upper bricks. They are a sixteenth of a whole scene, and more of a partly
 * resident one.
 */
const UPPER_PART = 1 / 6;

/**
 * Makes a cloud that streams the parts of a scene that views need. Resolves when the coarsest part
 * is on the GPU.
 *
 * @throws InvalidArgumentError if the budget does not hold a brick of each level; GpuLimitError if
 *   the device lacks memory; errors of `scene.read`. Nothing is left allocated then.
 */
export async function streamBricks(
  context: StreamContext,
  scene: BrickScene,
  options: StreamOptions,
  { onDestroyed }: Pick<SplatCloudOptions, 'onDestroyed'>,
): Promise<SplatCloud> {
  const { name, shDegree } = scene;
  const { least, most } = roomFor(scene);
  const need = { name, leastBytes: poolBytes(shDegree, least), mostBytes: poolBytes(shDegree, most) };
  checkBudget(need, options);
  // Starts compiling the pipelines early. Making the pool throws the same error if that fails.
  context.pipelines.prepare(rootStages(scene)).catch(() => {});
  const brick = await scene.read(scene.root, options.signal);
  return withShare(context.shares, need, options, async (shareBytes, leave) => {
    const pool = await BrickPool.make(context, scene, slotsFor(scene, shareBytes));
    const begin = () => new BrickStream(scene, pool, pool.place(brick, scene.root, null));
    const { made, stream } = streamInto(pool, begin, leave, { ...options, onDestroyed });
    return { made, resize: (bytes) => stream.resize(slotsFor(scene, bytes)) };
  });
}

/** Slots for the whole scene, or as many as the budget holds. */
function slotsFor(scene: BrickScene, budgetBytes: number): PoolSlots {
  const { shDegree } = scene;
  const { least, most } = roomFor(scene);
  if (poolBytes(shDegree, most) <= budgetBytes) return most;
  const bytes = slotBytes(shDegree);
  const upper = Math.max(least.upper, Math.floor((UPPER_PART * budgetBytes) / bytes.upper));
  const slots = { lowest: 0, upper: Math.min(most.upper, upper) };
  return { ...slots, lowest: Math.floor((budgetBytes - poolBytes(shDegree, slots)) / bytes.lowest) };
}

/** Slots for the coarsest drawable state of a scene, and slots for all of it. */
function roomFor({ splatCount, brickCount }: BrickScene): Readonly<Record<'least' | 'most', PoolSlots>> {
  const chunks = chunkCountOf(splatCount);
  const lowest = Math.ceil(chunks / CELL_CHILDREN);
  const most = { lowest, upper: Math.max(1, brickCount - lowest) };
  // One brick of each level from the root down, and one spare to replace another.
  const levels = Math.ceil(Math.log(chunks) / Math.log(CELL_CHILDREN)) + 1;
  return { least: { lowest: Math.min(2, lowest), upper: Math.min(levels, most.upper) }, most };
}
