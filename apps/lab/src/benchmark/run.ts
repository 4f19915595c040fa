import { InvalidArgumentError, SplatEngine } from '@websplatter/core';
import { measureFrames, orbitCameras } from '@websplatter/core/measure';
import { BUILD } from '../build.ts';
import { browserMachine } from './machine.ts';
import type { BenchmarkReport } from './report.ts';
import { benchmarkRequest } from './request.ts';
import { loadScene, type MeasuredScene } from './scene.ts';

/** Bytes of copies that show the memory's bandwidth: above most caches, bearable for a phone. */
const COPY_BYTES = 64 * 2 ** 20;

/** The current step of a benchmark. */
export interface BenchmarkProgress {
  readonly label: string;
  /** How much is done, 0…1; undefined where that is not known. */
  readonly part: number | undefined;
}

/**
 * Measures the scene of an address on an engine of its own, which is freed at the end.
 *
 * @throws InvalidArgumentError where the address asks for a thing that does not exist; errors of
 * loading and measuring; the reason of `signal`.
 */
export async function runBenchmark(
  query: URLSearchParams,
  signal: AbortSignal,
  onProgress: (progress: BenchmarkProgress) => void,
): Promise<BenchmarkReport> {
  const { widthPx, heightPx, frames, orbitDegrees, accuracy, accuracyLabel } = benchmarkRequest(query);
  onProgress({ label: 'Asking for the GPU', part: undefined });
  const engine = await SplatEngine.create({ accuracy });
  const errors: string[] = [];
  engine.device.addEventListener('uncapturederror', ({ error }) => errors.push(error.message));
  const visibility = watchVisibility();
  try {
    signal.throwIfAborted();
    const startedMs = performance.now();
    const scene = await loadScene(engine, query, {
      signal,
      onProgress: ({ loadedBytes, totalBytes }) =>
        onProgress({ label: 'Loading', part: totalBytes ? loadedBytes / totalBytes : undefined }),
    });
    const { clouds, title } = scene;
    if (clouds.every(({ cloud }) => cloud.count === 0))
      throw new InvalidArgumentError('scene', 'This scene has no splats, so there is nothing to measure.');
    await engine.device.queue.onSubmittedWorkDone();
    const loadMs = performance.now() - startedMs;
    const measurement = await measureFrames(engine, {
      clouds,
      cameras: orbitCameras(scene.camera(widthPx / heightPx), clouds[0].cloud.robustBounds, {
        count: frames,
        sweepDegrees: orbitDegrees,
      }),
      widthPx,
      heightPx,
      copyBytes: COPY_BYTES,
      signal,
      onProgress: ({ label, done, total }) => onProgress({ label, part: done / total }),
    });
    const [error] = errors;
    if (error !== undefined) throw new Error(`The GPU reported an error: ${error}`);
    return {
      ...BUILD,
      madeAt: new Date().toISOString(),
      machine: await browserMachine(navigator),
      scene: title,
      shDegree: Math.max(...clouds.map(({ cloud }) => cloud.shDegree)),
      accuracyLabel,
      orbitDegrees,
      loadMs,
      measurement: {
        ...measurement,
        notes: [...measurement.notes, ...fitNotes(scene), ...visibility.notes()],
      },
    };
  } finally {
    visibility.stop();
    engine.destroy();
  }
}

function fitNotes({ clouds }: MeasuredScene): string[] {
  return clouds.flatMap(({ cloud: { name, fit } }) => {
    if (!fit) return [];
    const { geometryPrecision, shPrecision, shDegree } = fit.taken;
    return `${name} is larger than the GPU's memory and was measured with ${geometryPrecision} geometry and ${shPrecision} harmonics of degree ${shDegree}.`;
  });
}

/** Browsers slow down pages that are out of sight. */
function watchVisibility(): { readonly notes: () => string[]; readonly stop: () => void } {
  let wasHidden = document.hidden;
  const listener = () => {
    wasHidden ||= document.hidden;
  };
  document.addEventListener('visibilitychange', listener);
  return {
    notes: () =>
      wasHidden
        ? ['The page was in the background for a while, where browsers slow it down: run it again in front.']
        : [],
    stop: () => document.removeEventListener('visibilitychange', listener),
  };
}
