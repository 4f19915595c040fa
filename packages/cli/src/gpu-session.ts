import {
  type AccuracySettings,
  lastingSource,
  loadSplats,
  type SplatCloud,
  SplatEngine,
  WebSplatterError,
} from '@websplatter/core';
import { createNodeGpu } from '@websplatter/node';
import type { SceneSource } from './scene-source.ts';

/** An engine on a GPU or a software adapter. */
export interface Gpu {
  readonly engine: SplatEngine;
  /** Message for the user when no GPU was found, otherwise null. */
  readonly notice: string | null;
  /** @throws WebSplatterError 'gpu-error' with the first GPU error, if there was one. */
  checkGpuErrors(): void;
}

/** An engine with the scenes of a command line. */
export interface GpuSession extends Gpu {
  /** One per scene, in order. */
  readonly clouds: readonly SplatCloud[];
}

/**
 * Reads `scenes`, then uploads them. No driver is opened before all scenes have been read: bad
 * input fails sooner, and no output of a driver precedes the one line about it.
 *
 * @param accuracy the engine's settings, for which the splats are packed.
 */
export async function openGpuSession(
  scenes: readonly SceneSource[],
  accuracy: AccuracySettings,
): Promise<GpuSession> {
  const uploads: Upload[] = [];
  for (const scene of scenes) uploads.push(await readForUpload(scene, accuracy));
  const gpu = await openGpu(accuracy);
  try {
    const clouds = uploads.map((upload) => upload(gpu.engine));
    return { ...gpu, clouds };
  } catch (error) {
    gpu.engine.destroy();
    throw error;
  }
}

/** @param accuracy the engine's settings. */
export async function openGpu(accuracy: AccuracySettings): Promise<Gpu> {
  const { gpu, adapter, notice } = await createNodeGpu();
  const engine = await SplatEngine.create({ gpu, adapter, accuracy });
  const gpuErrors: string[] = [];
  engine.device.addEventListener('uncapturederror', (event) => {
    event.preventDefault();
    gpuErrors.push(event.error.message);
  });
  const checkGpuErrors = () => {
    if (gpuErrors.length > 0) throw new WebSplatterError('gpu-error', `the GPU refused: ${gpuErrors[0]}`);
  };
  return { engine, notice, checkGpuErrors };
}

type Upload = (engine: SplatEngine) => SplatCloud;

async function readForUpload(scene: SceneSource, accuracy: AccuracySettings): Promise<Upload> {
  const { name, source, limits, format } = scene;
  const { geometryPrecision, shPrecision } = accuracy;
  const sourceOptions = { ...limits, format };
  const packed = await loadSplats(source, { ...sourceOptions, name, geometryPrecision, shPrecision });
  return (engine) => engine.addPacked(packed, { name, source: lastingSource(source), sourceOptions });
}
