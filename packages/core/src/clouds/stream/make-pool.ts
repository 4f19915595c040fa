import type { BrickScene } from '../../data/bricks/brick.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import type { DispatchContext } from '../ingest/dispatches.ts';
import type { Levels } from '../levels.ts';
import { type CloudPool, SplatCloud, type SplatCloudOptions } from '../splat-cloud.ts';
import { type ChunkPages, STREAM_PRECISION } from './chunk-pages.ts';

/** Properties of a streamed scene that its cloud exposes. */
export type StreamedScene = Pick<
  BrickScene,
  'name' | 'splatCount' | 'shDegree' | 'isAntialiased' | 'origin' | 'bounds' | 'robustBounds'
>;

/** Advice in the error if the device lacks memory for a pool. */
const POOL_ADVICE = 'Give it fewer bytes.';

/**
 * Makes a pool with its own share of GPU memory.
 *
 * @throws GpuLimitError if the device lacks the memory; nothing is left allocated then.
 */
export async function makePool<Pool>(
  context: DispatchContext,
  { name }: { readonly name: string },
  stages: readonly StageDefinition[],
  make: (memory: GpuMemory) => Pool,
): Promise<Pool> {
  const memory = context.memory.part();
  await context.pipelines.prepare(stages);
  const { result: pool, checked } = memory.guard(name, POOL_ADVICE, () => {
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

/**
 * Replaces the pool of a cloud by one of another size. If the device lacks the memory, the cloud is
 * destroyed.
 *
 * @returns null if the engine's memory budget has no room for it; nothing is made then.
 */
export function resizedPool<Pool extends CloudPool & Levels>(
  memory: GpuMemory,
  cloud: SplatCloud,
  growthBytes: number,
  make: () => { readonly pool: Pool; readonly pages: ChunkPages },
): Pool | null {
  if (growthBytes > memory.availableBytes) return null;
  const { result, checked } = memory.guard(cloud.name, POOL_ADVICE, make);
  const { planes, rows } = result.pages;
  cloud.takePool(result.pool, { planes, fileIndices: rows }, checked);
  return result.pool;
}

/** A cloud that draws a pool. */
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
    // Unknown until the whole scene is resident: assume that every band matters.
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
    chunks: pool.chunks,
    precision: STREAM_PRECISION,
  };
  const cloud = new SplatCloud(device, pages.planes, contents, { ...options, name, pool });
  cloud.levels = pool;
  return cloud;
}
