// Hooks that follow the engine of a Canvas.
import type {
  CloudStream,
  DrawnAccuracy,
  EffectEntry,
  EngineMemory,
  SplatEngine,
  StreamReport,
} from '@websplatter/core';
import { onStageTimings } from '@websplatter/three';
import { useEffect, useRef, useState } from 'react';
import { isSameValue } from './effect-props.ts';
import { useLatest } from './stable-values.ts';
import { useMeasuredRenderer } from './use-renderer.ts';
import { useSplatEngine } from './use-splat-engine.ts';

/** Time from a frame to a look at the engine: a component renders four times a second at most. */
const LOOK_AFTER_MS = 250;

/**
 * Returns the GPU memory that the engine of a Canvas holds, in bytes: of all clouds, of each, and
 * of drawing. Looks again a quarter of a second after frames, and causes a render only if something
 * has changed.
 *
 * @param select returns what of it a component needs, which then renders for changes of that alone.
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`).
 * @returns null before the first look.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that cannot draw splats.
 *
 * @example
 * const bytes = useSplatMemory(({ totalBytes }) => totalBytes);
 */
export function useSplatMemory<Selected>(
  select: (found: EngineMemory) => Selected,
  renderer?: object,
): Selected | null;
export function useSplatMemory(renderer?: object): EngineMemory | null;
export function useSplatMemory<Selected>(
  ...given: HookArguments<EngineMemory, Selected>
): EngineMemory | Selected | null {
  return useEngine(readMemory, given, 'useSplatMemory');
}

/**
 * Returns all effects of the last frame of a Canvas, on and off, each with the reason and the GPU
 * memory that it holds. Looks again a quarter of a second after frames, and causes a render only if
 * something has changed.
 *
 * @param select returns what of it a component needs, which then renders for changes of that alone.
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`).
 * @returns null before the first look; an empty list before the first frame.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that cannot draw splats.
 *
 * @example
 * const shown = useSplatEffects((effects) => effects.filter(({ isOn }) => isOn).length);
 */
export function useSplatEffects<Selected>(
  select: (found: readonly EffectEntry[]) => Selected,
  renderer?: object,
): Selected | null;
export function useSplatEffects(renderer?: object): readonly EffectEntry[] | null;
export function useSplatEffects<Selected>(
  ...given: HookArguments<readonly EffectEntry[], Selected>
): readonly EffectEntry[] | Selected | null {
  return useEngine(readEffects, given, 'useSplatEffects');
}

/**
 * Returns the accuracy of a Canvas's last frame: its settings, the choice for a target and its
 * reason, and the rasteriser. Looks again a quarter of a second after frames, and causes a render
 * only if something has changed.
 *
 * @param select returns what of it a component needs, which then renders for changes of that alone.
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`).
 * @returns null before the first frame.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that cannot draw splats.
 *
 * @example
 * const rasterizer = useSplatAccuracy((accuracy) => accuracy.rasterizer);
 */
export function useSplatAccuracy<Selected>(
  select: (found: DrawnAccuracy) => Selected,
  renderer?: object,
): Selected | null;
export function useSplatAccuracy(renderer?: object): DrawnAccuracy | null;
export function useSplatAccuracy<Selected>(
  ...given: HookArguments<DrawnAccuracy, Selected>
): DrawnAccuracy | Selected | null {
  return useEngine(readAccuracy, given, 'useSplatAccuracy');
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
 * @param select returns what of it a component needs, which then renders for changes of that alone.
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`).
 * @returns null before the first look; an empty list where nothing streams.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that cannot draw splats.
 *
 * @example
 * const isComplete = useSplatStreams((streams) => streams.every((stream) => stream.isComplete));
 */
export function useSplatStreams<Selected>(
  select: (found: readonly SplatStream[]) => Selected,
  renderer?: object,
): Selected | null;
export function useSplatStreams(renderer?: object): readonly SplatStream[] | null;
export function useSplatStreams<Selected>(
  ...given: HookArguments<readonly SplatStream[], Selected>
): readonly SplatStream[] | Selected | null {
  return useEngine(readStreams, given, 'useSplatStreams', followStreams);
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

/** `select`, `renderer`, both or neither. */
type HookArguments<Found, Selected> = [((found: Found) => Selected) | object | undefined, object?];

/**
 * Returns the result of `read` on the engine, or what the hook's caller selects of it: read again
 * after frames and when `follow`, told what was found, calls `look`. Both are always the same
 * functions.
 */
function useEngine<Found, Selected>(
  read: (engine: SplatEngine) => Found | null,
  [first, second]: HookArguments<Found, Selected>,
  who: string,
  follow?: (found: Found, look: () => void) => () => void,
): Found | Selected | null {
  const [select, renderer] = typeof first === 'function' ? [first, second] : [undefined, first];
  const measured = useMeasuredRenderer(renderer, who);
  const engine = useSplatEngine(measured);
  const [found, setFound] = useState<Found | null>(null);
  const selectedOf = (of: Found | null): Found | Selected | null => (of !== null && select ? select(of) : of);
  const selected = selectedOf(found);
  const newest = useRef<Found | null>(null);
  const latest = useLatest(() => {
    if (found !== newest.current && !isSameValue(selected, selectedOf(newest.current)))
      setFound(newest.current);
  });
  // Another selection may be about what has changed meanwhile.
  useEffect(() => latest.current());
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    let unfollow: (() => void) | undefined;
    const lookLater = () => {
      timer ??= setTimeout(look, LOOK_AFTER_MS);
    };
    if (!engine) return;
    const look = () => {
      timer = undefined;
      const now = read(engine);
      unfollow?.();
      unfollow = now === null ? undefined : follow?.(now, lookLater);
      newest.current = now;
      latest.current();
    };
    look();
    const stop = onStageTimings(measured, lookLater);
    return () => {
      stop();
      unfollow?.();
      clearTimeout(timer);
    };
  }, [measured, engine, read, follow, latest]);
  return selected;
}
