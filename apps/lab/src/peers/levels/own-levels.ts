import type { SplatCloud, SplatEngine } from '@websplatter/core';
import { antialias } from '@websplatter/core/effects';
import { measureFrames } from '@websplatter/core/measure';
import type { Levels } from './levels.ts';
import { SIZE } from './pictures.ts';

/** Stages that a frame has only for choosing. */
const CUT_STAGES = ['cut-cells', 'cut-count', 'plan-cut', 'cut-splats'];

/** Levels of our own: pictures are those of `whole`, times those of `addBalanced`'s. */
export async function* ownLevels(
  engine: SplatEngine,
  whole: SplatCloud,
  addBalanced: () => SplatCloud,
): AsyncGenerator<Levels> {
  const buildMs: number[] = [];
  const build = async () => {
    const cloud = addBalanced();
    await cloud.uploaded;
    await engine.device.queue.onSubmittedWorkDone();
    const startedMs = performance.now();
    await cloud.makeLevels();
    await engine.device.queue.onSubmittedWorkDone();
    buildMs.push(performance.now() - startedMs);
    return cloud;
  };
  // The first time with shaders to compile.
  (await build()).destroy();
  const cloud = await build();
  await whole.makeLevels();
  const budgetOf = (share: number) => ({ maxSplats: Math.round(share * whole.count) });
  yield {
    name: 'WebSplatter',
    buildMs,
    choose: async (_, share) => ({ instance: { cloud: whole }, detail: budgetOf(share) }),
    async choiceMs(cameras, share) {
      const clouds = [{ cloud, effects: [antialias()] }];
      const frame = { clouds, ...SIZE, accuracy: 'balanced' as const, cameras, detail: budgetOf(share) };
      const { passes } = await measureFrames(engine, frame);
      const cut = passes?.filter(({ stage }) => CUT_STAGES.includes(stage));
      return cut?.reduce((sum, { timeMs }) => sum + timeMs.median, 0) ?? null;
    },
  };
  cloud.destroy();
}
