import { InvalidArgumentError, SplatEngine } from '@websplatter/core';
import { measureFrames } from '@websplatter/core/measure';
import { BUILD } from '../formatting/build.ts';
import { addressedScene } from '../scene/addressed-scene.ts';
import { firstSource } from '../scene/first-source.ts';
import { fitNotice } from '../scene/fit-notice.ts';
import { type LoadedScene, loadScene } from '../scene/load-scene.ts';
import { type SceneSource, titleOfAll } from '../scene/scene-source.ts';
import { benchCameras } from './bench-path.ts';
import type { BenchReport } from './bench-report.ts';
import { benchRequest } from './bench-request.ts';
import { browserMachine } from './machine.ts';

/** Bytes of the copies that tell the memory's bandwidth: more than most caches hold, and no more than a phone can spare. */
const COPY_BYTES = 64 * 2 ** 20;

/** What a benchmark is doing. */
export interface BenchProgress {
  readonly label: string;
  /** How much is done, 0…1; undefined where that is not known. */
  readonly part: number | undefined;
}

export interface BenchOptions {
  /** Of the page's address. */
  readonly query: URLSearchParams;
  readonly signal: AbortSignal;
  readonly onProgress: (progress: BenchProgress) => void;
}

/**
 * Measures the scene of an address on an engine of its own, which is freed at the end.
 *
 * @throws InvalidArgumentError where the address asks for what there is not; what loading and measuring throw; the reason of
 * `signal`.
 */
export async function runBench({ query, signal, onProgress }: BenchOptions): Promise<BenchReport> {
  const request = benchRequest(query);
  const sources = sourcesOf(query);
  onProgress({ label: 'Asking for the GPU', part: undefined });
  const engine = await SplatEngine.create({ accuracy: request.accuracy });
  const errors: string[] = [];
  engine.device.addEventListener('uncapturederror', ({ error }) => errors.push(error.message));
  const visibility = watchVisibility();
  try {
    signal.throwIfAborted();
    const startedMs = performance.now();
    const scenes: LoadedScene[] = [];
    for (const source of sources)
      scenes.push(
        await loadScene(engine, source, {
          signal,
          onProgress: ({ loadedBytes, totalBytes }) =>
            onProgress({ label: 'Loading', part: totalBytes ? loadedBytes / totalBytes : undefined }),
          onPreview: () => {},
        }),
      );
    // It stands as the first of its files does.
    const scene = { ...scenes[0], clouds: scenes.flatMap(({ clouds }) => clouds) };
    await settle(engine, scene);
    const loadMs = performance.now() - startedMs;
    const measurement = await measureFrames(engine, {
      clouds: scene.clouds,
      cameras: benchCameras(scene, request),
      widthPx: request.widthPx,
      heightPx: request.heightPx,
      copyBytes: COPY_BYTES,
      signal,
      onProgress: ({ label, done, total }) => onProgress({ label, part: done / total }),
    });
    const [error] = errors;
    if (error !== undefined) throw new Error(`The GPU reported an error: ${error}`);
    const title = titleOfAll(sources);
    return {
      ...BUILD,
      madeAt: new Date().toISOString(),
      machine: await browserMachine(navigator),
      scene: { title, ...summaryOf(scene) },
      sweepDegrees: request.sweepDegrees,
      accuracy: request.accuracy,
      loadMs,
      measurement,
      notes: [...measurement.notes, ...fitNotes(title, scene), ...visibility.notes()],
    };
  } finally {
    visibility.stop();
    engine.destroy();
  }
}

/** Measuring another scene than was asked for would say nothing. */
function sourcesOf(query: URLSearchParams): readonly SceneSource[] {
  // The same scene on every device, however slow.
  const { sources, notice, failure } = firstSource(addressedScene(query), location.href, false);
  if (failure) throw new InvalidArgumentError('src', `${failure.message} ${failure.advice}`);
  if (notice !== null) throw new InvalidArgumentError('scene', notice);
  return sources;
}

/** Waits until the GPU has all of the scene. */
async function settle(engine: SplatEngine, { clouds }: LoadedScene): Promise<void> {
  if (clouds.every(({ cloud }) => cloud.count === 0))
    throw new InvalidArgumentError('scene', 'This scene has no splats, so there is nothing to measure.');
  await engine.device.queue.onSubmittedWorkDone();
}

function summaryOf({ clouds }: LoadedScene): Omit<BenchReport['scene'], 'title'> {
  return {
    clouds: clouds.length,
    splats: clouds.reduce((sum, { cloud }) => sum + cloud.count, 0),
    shDegree: Math.max(...clouds.map(({ cloud }) => cloud.shDegree)),
  };
}

function fitNotes(title: string, { clouds }: LoadedScene): string[] {
  return clouds.flatMap(({ cloud }) => (cloud.fit ? [fitNotice(title, cloud.fit)] : []));
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
