import {
  type AccuracySettings,
  loadSplats,
  type PackedCloud,
  packCloud,
  type SplatCloud,
} from '@websplatter/core';
import { syntheticPly } from '@websplatter/scenes';
import type { BenchOptions } from './bench-options.ts';
import { type Gpu, openGpu } from './gpu-session.ts';
import { findScene, type SceneSource } from './scene-source.ts';

/** What loading a scene took, in milliseconds. */
export interface LoadTimes {
  /** Reading and decoding; of a scene that is made by code, making it. */
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

/** Finds the scene of a command line, which it does not read yet. */
export async function findBenchScene(scene: BenchOptions['scene']): Promise<SceneSource> {
  if (scene.kind === 'named') return findScene(scene.name);
  const { splats, shDegree, seed } = scene;
  const name = `synthetic (degree ${shDegree}, seed ${seed})`;
  return { name, content: { source: syntheticPly({ splats, shDegree, seed }) } };
}

/**
 * Loads a scene the way that applications do, and times the steps. No driver is opened before the scene has been read.
 *
 * @param accuracy the engine's settings, for which the splats are packed.
 */
export async function loadTimed(scene: SceneSource, accuracy: AccuracySettings): Promise<LoadedScene> {
  const { packed, readMs, packMs } = await readTimed(scene, accuracy);
  const gpu = await openGpu(accuracy);
  try {
    const startedMs = performance.now();
    const cloud = gpu.engine.addPacked(packed, { name: scene.name });
    await gpu.engine.device.queue.onSubmittedWorkDone();
    return { ...gpu, cloud, load: { readMs, packMs, uploadMs: performance.now() - startedMs } };
  } catch (error) {
    gpu.engine.destroy();
    throw error;
  }
}

async function readTimed(
  { name, content }: SceneSource,
  { geometryPrecision, shPrecision }: AccuracySettings,
): Promise<{ packed: PackedCloud; readMs: number; packMs: number }> {
  const precision = { geometryPrecision, shPrecision };
  const startedMs = performance.now();
  let readMs: number | null = null;
  const endReading = () => {
    readMs ??= performance.now() - startedMs;
  };
  let packed: PackedCloud;
  if ('make' in content) {
    const set = content.make();
    endReading();
    packed = packCloud(set, precision);
  } else {
    packed = await loadSplats(content.source, {
      ...precision,
      name,
      onProgress: ({ phase }) => {
        if (phase !== 'read') endReading();
      },
    });
  }
  const totalMs = performance.now() - startedMs;
  // A source without progress counts as read.
  return { packed, readMs: readMs ?? totalMs, packMs: totalMs - (readMs ?? totalMs) };
}
