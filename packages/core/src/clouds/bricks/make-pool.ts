import type { BrickScene } from '../../data/bricks/brick.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import type { DispatchContext } from '../ingest/dispatches.ts';
import type { Levels } from '../levels.ts';
import { type CloudPool, SplatCloud, type SplatCloudOptions } from '../splat-cloud.ts';
import { type ChunkPages, STREAM_PRECISION } from './chunk-pages.ts';

/** What a cloud tells of a scene of which it shows parts. */
export type StreamedScene = Pick<
  BrickScene,
  'name' | 'splatCount' | 'shDegree' | 'isAntialiased' | 'origin' | 'bounds' | 'robustBounds'
>;

/**
 * Makes a pool, in GPU memory of its own.
 *
 * @throws GpuLimitError if the device has no room for it; nothing is left allocated then.
 */
export async function makePool<Pool>(
  context: DispatchContext,
  { name }: { readonly name: string },
  stages: readonly StageDefinition[],
  make: (memory: GpuMemory) => Pool,
): Promise<Pool> {
  const memory = context.memory.part();
  await context.pipelines.prepare(stages);
  const { result: pool, checked } = memory.guard(name, 'Give it fewer bytes.', () => {
    try {
      return make(memory);
    } catch (error) {
      memory.destroyAll();
      throw error;
    }
  });
  await checked?.catch((error) => {
    memory.destroyAll();
    throw error;
  });
  return pool;
}

/** A cloud that shows what is in a pool. */
export function streamedCloud(
  device: GPUDevice,
  { name, splatCount, shDegree, isAntialiased, origin, bounds, robustBounds }: StreamedScene,
  pages: ChunkPages,
  pool: CloudPool & Levels,
  options: Pick<SplatCloudOptions, 'onDestroyed'>,
): SplatCloud {
  const facts = {
    declaredShDegree: shDegree,
    trueShDegree: shDegree,
    // What can be seen is not known before all is there.
    shBandReach: Array.from({ length: shDegree }, () => Number.POSITIVE_INFINITY),
    paletteEntries: null,
    isIsotropic: false,
    isAntialiased: isAntialiased ?? null,
    fileFacts: null,
  };
  const contents = {
    count: splatCount,
    origin,
    bounds,
    robustBounds,
    dropped: {},
    fileIndices: pages.rows,
    facts,
    chunks: pages.words.buffer,
    precision: STREAM_PRECISION,
  };
  const cloud = new SplatCloud(device, pages.planes, contents, { ...options, name, pool });
  cloud.levels = pool;
  return cloud;
}
