import type { BrickScene } from '../../data/bricks/brick.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import { streamInto } from '../stream/scene-pool.ts';
import { checkBudget, type StreamContext, type StreamOptions } from '../stream/stream-budget.ts';
import { BrickParts } from './brick-parts.ts';
import { BrickPool, poolBytes, roomFor, rootStages, slotsFor } from './brick-pool.ts';

export { FIRST_STAGES } from '../stream/chunk-pages.ts';

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
  const makePool = (bytes: number) => BrickPool.make(context, scene, slotsFor(scene, bytes));
  const begin = (pool: BrickPool) => {
    const root = pool.place(brick, scene.root, null);
    pool.merge();
    return new BrickParts(scene, pool, root);
  };
  return streamInto(context, need, { ...options, onDestroyed }, makePool, begin);
}
