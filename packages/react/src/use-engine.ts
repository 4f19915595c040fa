// Hooks that follow the engine of a Canvas.
import type {
  CloudStream,
  DrawnAccuracy,
  EffectEntry,
  EngineMemory,
  SplatEngine,
  StreamReport,
} from '@websplatter/core';
import { onStageTimings, splatEngineOf } from '@websplatter/three';
import { useEffect, useState } from 'react';
import { isSameValue } from './effect-props.ts';
import { useMeasuredRenderer } from './use-renderer.ts';

/** Time from a frame to a look at the engine: a component renders four times a second at most. */
const LOOK_AFTER_MS = 250;

/**
 * Returns the GPU memory that the engine of a Canvas holds, in bytes: of all clouds, of each, and
 * of drawing. Looks again a quarter of a second after frames, and causes a render only if something
 * has changed.
 *
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`).
 * @returns null before the first look.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that `createSplatRenderer` did not make.
 */
export function useSplatMemory(renderer?: object): EngineMemory | null {
  return useEngine(readMemory, renderer, 'useSplatMemory');
}

/**
 * Returns all effects of the last frame of a Canvas, on and off, each with the reason and the GPU
 * memory that it holds. Looks again a quarter of a second after frames, and causes a render only if
 * something has changed.
 *
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`).
 * @returns null before the first look; an empty list before the first frame.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that `createSplatRenderer` did not make.
 */
export function useSplatEffects(renderer?: object): readonly EffectEntry[] | null {
  return useEngine(readEffects, renderer, 'useSplatEffects');
}

/**
 * Returns the accuracy of a Canvas's last frame: its settings, the choice for a target and its
 * reason, and the rasteriser. Looks again a quarter of a second after frames, and causes a render
 * only if something has changed.
 *
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`).
 * @returns null before the first frame.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that `createSplatRenderer` did not make.
 */
export function useSplatAccuracy(renderer?: object): DrawnAccuracy | null {
  return useEngine(readAccuracy, renderer, 'useSplatAccuracy');
}

/** What is there of a scene that streams. */
export interface SplatStream extends StreamReport {
  /** That of the cloud. */
  readonly name: string;
  /** Its `retry` fetches again what could not be. */
  readonly stream: CloudStream;
}

/**
 * Returns what is there of each scene that a Canvas streams: how many bricks are on the GPU and how
 * many are missing, bytes, bytes per second, and the error of the last fetch. Looks again a quarter
 * of a second after a change, and while anything is fetched, and causes a render only if something
 * has changed.
 *
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`).
 * @returns null before the first look; an empty list where nothing streams.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that `createSplatRenderer` did not make.
 */
export function useSplatStreams(renderer?: object): readonly SplatStream[] | null {
  return useEngine(readStreams, renderer, 'useSplatStreams', followStreams);
}

function readStreams({ clouds }: SplatEngine): readonly SplatStream[] {
  return clouds.flatMap(({ name, stream }) => (stream ? { name, stream, ...stream.report() } : []));
}

/** Calls `look` when streams change, and soon while they fetch: their rates change by themselves. */
function followStreams(streams: readonly SplatStream[], look: () => void): () => void {
  const stops = streams.map(({ stream }) => stream.subscribe(look));
  if (streams.some(({ fetching }) => fetching > 0)) look();
  return () => {
    for (const stop of stops) stop();
  };
}

const readAccuracy = (engine: SplatEngine) => engine.drawnAccuracy();
const readMemory = (engine: SplatEngine) => engine.memory();
const readEffects = (engine: SplatEngine) => engine.effects();

/**
 * Returns the result of `read` on the engine, read again after frames and when `follow`, told what
 * was found, calls `look`. Both are always the same functions.
 */
function useEngine<Found>(
  read: (engine: SplatEngine) => Found,
  renderer: object | undefined,
  who: string,
  follow?: (found: Found, look: () => void) => () => void,
): Found | null {
  const measured = useMeasuredRenderer(renderer, who);
  const engine = splatEngineOf(measured);
  const [found, setFound] = useState<Found | null>(null);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    let latest: Found | null = null;
    let unfollow: (() => void) | undefined;
    const lookLater = () => {
      timer ??= setTimeout(look, LOOK_AFTER_MS);
    };
    const look = () => {
      timer = undefined;
      const now = read(engine);
      unfollow?.();
      unfollow = follow?.(now, lookLater);
      if (isSameValue(latest, now)) return;
      latest = now;
      setFound(now);
    };
    look();
    const stop = onStageTimings(measured, lookLater);
    return () => {
      stop();
      unfollow?.();
      clearTimeout(timer);
    };
  }, [measured, engine, read, follow]);
  return found;
}
