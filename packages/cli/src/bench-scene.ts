import { type AccuracySettings, loadSplats, type PackedCloud, type SplatCloud } from '@websplatter/core';
import { syntheticPly } from '@websplatter/scenes';
import type { BenchOptions } from './bench-options.ts';
import { type Gpu, openGpu } from './gpu-session.ts';
import { findScene, type SceneSource } from './scene-source.ts';

/** Times that the steps of loading a scene took, in milliseconds. */
export interface LoadTimes {
  /** Reading and decoding the splats; making them too where code does. */
  readonly readMs: number;
  /** Sorting into storage order and packing. */
  readonly packMs: number;
  /** From the first upload until the GPU has everything. */
  readonly uploadMs: number;
}

/** A scene on the GPU. */
export interface LoadedScene extends Gpu {
  readonly cloud: SplatCloud;
  readonly load: LoadTimes;
}

/** A scene to measure, still unread. */
export interface BenchScene extends SceneSource {
  /** Whether code makes the splats. */
  readonly isMade: boolean;
}

/** Finds the scene that a command line names, without reading its splats. */
export async function findBenchScene(scene: BenchOptions['scene']): Promise<BenchScene> {
  if (scene.kind === 'named') {
    return { ...(await findScene(scene.name, scene.format)), isMade: false };
  }
  const { splats, shDegree, seed } = scene;
  const name = `synthetic (degree ${shDegree}, seed ${seed})`;
  return {
    name,
    source: syntheticPly({ splats, shDegree, seed }),
    limits: {},
    files: new Set(),
    isBuiltin: false,
    isMade: true,
  };
}

/**
 * Loads a scene the way that applications do, and times the steps. No driver is opened before the
 * scene has been read.
 *
 * @param accuracy the engine's settings, for which the splats are packed.
 */
export async function loadTimed(scene: SceneSource, accuracy: AccuracySettings): Promise<LoadedScene> {
  const { packed, ...read } = await readTimed(scene, accuracy);
  const gpu = await openGpu(accuracy);
  try {
    const startedMs = performance.now();
    const cloud = gpu.engine.addPacked(packed, { name: scene.name });
    await gpu.engine.device.queue.onSubmittedWorkDone();
    const uploadMs = performance.now() - startedMs;
    return { ...gpu, cloud, load: { ...read, uploadMs } };
  } catch (error) {
    gpu.engine.destroy();
    throw error;
  }
}

async function readTimed(
  { name, source, limits, format }: SceneSource,
  { geometryPrecision, shPrecision }: AccuracySettings,
): Promise<{ packed: PackedCloud } & Omit<LoadTimes, 'uploadMs'>> {
  const startedMs = performance.now();
  let readMs: number | null = null;
  const endReading = () => {
    readMs ??= performance.now() - startedMs;
  };
  const packed = await loadSplats(source, {
    ...limits,
    format,
    geometryPrecision,
    shPrecision,
    name,
    onProgress: ({ phase }) => {
      if (phase !== 'read') endReading();
    },
  });
  const totalMs = performance.now() - startedMs;
  // A source without progress counts as read.
  return { packed, readMs: readMs ?? totalMs, packMs: totalMs - (readMs ?? totalMs) };
}
