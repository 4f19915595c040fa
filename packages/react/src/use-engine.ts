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

/** Delay from a frame to reading the engine, ms: a component renders at most four times a second. */
const READ_AFTER_MS = 250;

/**
 * Returns the GPU memory that the engine of a Canvas holds, in bytes: of all clouds, of each cloud,
 * and of drawing. Read four times a second, since memory is freed without a frame; renders only if
 * something has changed.
 *
 * @param select returns a part of the result; the component then renders only if that part changes.
 * @param renderer required outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null or
 *   undefined until then.
 * @returns null before the first reading.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that cannot draw splats.
 *
 * @example
 * const bytes = useSplatMemory(({ totalBytes }) => totalBytes);
 */
export function useSplatMemory<Selected>(
  select: (found: EngineMemory) => Selected,
  renderer?: object | null,
): Selected | null;
export function useSplatMemory(renderer?: object | null): EngineMemory | null;
export function useSplatMemory<Selected>(
  ...given: HookArguments<EngineMemory, Selected>
): EngineMemory | Selected | null {
  return useEngine(readMemory, given, 'useSplatMemory', readAgain);
}

/**
 * Returns all effects of the last frame of a Canvas, on and off, each with the reason and the GPU
 * memory that it holds. Read again a quarter of a second after frames; renders only if something has
 * changed.
 *
 * @param select returns a part of the result; the component then renders only if that part changes.
 * @param renderer required outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null or
 *   undefined until then.
 * @returns null before the first reading; an empty list before the first frame.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that cannot draw splats.
 *
 * @example
 * const shown = useSplatEffects((effects) => effects.filter(({ isOn }) => isOn).length);
 */
export function useSplatEffects<Selected>(
  select: (found: readonly EffectEntry[]) => Selected,
  renderer?: object | null,
): Selected | null;
export function useSplatEffects(renderer?: object | null): readonly EffectEntry[] | null;
export function useSplatEffects<Selected>(
  ...given: HookArguments<readonly EffectEntry[], Selected>
): readonly EffectEntry[] | Selected | null {
  return useEngine(readEffects, given, 'useSplatEffects');
}

/**
 * Returns the accuracy of a Canvas's last frame: its settings, the choice for a target and its
 * reason, and the rasteriser. Read again a quarter of a second after frames; renders only if something
 * has changed.
 *
 * @param select returns a part of the result; the component then renders only if that part changes.
 * @param renderer required outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null or
 *   undefined until then.
 * @returns null before the first frame.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that cannot draw splats.
 *
 * @example
 * const rasterizer = useSplatAccuracy((accuracy) => accuracy.rasterizer);
 */
export function useSplatAccuracy<Selected>(
  select: (found: DrawnAccuracy) => Selected,
  renderer?: object | null,
): Selected | null;
export function useSplatAccuracy(renderer?: object | null): DrawnAccuracy | null;
export function useSplatAccuracy<Selected>(
  ...given: HookArguments<DrawnAccuracy, Selected>
): DrawnAccuracy | Selected | null {
  return useEngine(readAccuracy, given, 'useSplatAccuracy');
}

/** State of a streamed scene. */
export interface SplatStream extends StreamReport {
  /** Name of the cloud. */
  readonly name: string;
  /** The cloud's stream; its `retry` fetches failed parts again. */
  readonly stream: CloudStream;
}

/**
 * Returns the state of each streamed scene of a Canvas: numbers of bricks on the GPU and missing,
 * bytes, bytes per second, and the error of the last fetch. Read again a quarter of a second after a
 * change, and repeatedly while parts are fetched; renders only if something has changed.
 *
 * @param select returns a part of the result; the component then renders only if that part changes.
 * @param renderer required outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null or
 *   undefined until then.
 * @returns null before the first reading; an empty list if no scene streams.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for renderers that cannot draw splats.
 *
 * @example
 * const isComplete = useSplatStreams((streams) => streams.every((stream) => stream.isComplete));
 */
export function useSplatStreams<Selected>(
  select: (found: readonly SplatStream[]) => Selected,
  renderer?: object | null,
): Selected | null;
export function useSplatStreams(renderer?: object | null): readonly SplatStream[] | null;
export function useSplatStreams<Selected>(
  ...given: HookArguments<readonly SplatStream[], Selected>
): readonly SplatStream[] | Selected | null {
  return useEngine(readStreams, given, 'useSplatStreams', subscribeToStreams);
}

function readStreams({ clouds }: SplatEngine): readonly SplatStream[] {
  return clouds.flatMap(({ name, stream }) => (stream ? { name, stream, ...stream.report() } : []));
}

/** Calls `onChange` when streams change, and at once while they fetch: rates change without events. */
function subscribeToStreams(streams: readonly SplatStream[], onChange: () => void): () => void {
  const stops = streams.map(({ stream }) => stream.subscribe(onChange));
  if (streams.some(({ fetching }) => fetching > 0)) onChange();
  return () => {
    for (const stop of stops) stop();
  };
}

/** Reads again and again: no frame follows where memory is freed. */
function readAgain(_memory: EngineMemory, onChange: () => void): () => void {
  onChange();
  return () => {};
}

const readAccuracy = (engine: SplatEngine) => engine.drawnAccuracy();
const readMemory = (engine: SplatEngine) => engine.memory();
const readEffects = (engine: SplatEngine) => engine.effects();

/** `select`, `renderer`, both or neither. */
type HookArguments<Found, Selected> = [(((found: Found) => Selected) | object | null)?, (object | null)?];

/**
 * Returns the result of `read` on the engine, or the part that the hook's caller selects. Reads again
 * after frames, and after calls of `onChange` by `subscribe`. Pass the same `read` and `subscribe` in
 * each render.
 */
function useEngine<Found, Selected>(
  read: (engine: SplatEngine) => Found | null,
  given: HookArguments<Found, Selected>,
  who: string,
  subscribe?: (found: Found, onChange: () => void) => () => void,
): Found | Selected | null {
  const [first, ...others] = given;
  const select = typeof first === 'function' ? (first as (found: Found) => Selected) : undefined;
  const measured = useMeasuredRenderer(select ? others : given, who);
  const engine = useSplatEngine(measured);
  const [found, setFound] = useState<Found | null>(null);
  const selectedOf = (of: Found | null): Found | Selected | null => (of !== null && select ? select(of) : of);
  const selected = selectedOf(found);
  const newest = useRef<Found | null>(null);
  const latest = useLatest(() => {
    if (found !== newest.current && !isSameValue(selected, selectedOf(newest.current)))
      setFound(newest.current);
  });
  // `select` may have changed: apply it to the newest result.
  useEffect(() => latest.current());
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    let unsubscribe: (() => void) | undefined;
    const updateLater = () => {
      timer ??= setTimeout(update, READ_AFTER_MS);
    };
    if (!measured || !engine) return;
    const update = () => {
      timer = undefined;
      const now = read(engine);
      unsubscribe?.();
      unsubscribe = now === null ? undefined : subscribe?.(now, updateLater);
      newest.current = now;
      latest.current();
    };
    update();
    const stop = onStageTimings(measured, updateLater);
    return () => {
      stop();
      unsubscribe?.();
      clearTimeout(timer);
    };
  }, [measured, engine, read, subscribe, latest]);
  return selected;
}
