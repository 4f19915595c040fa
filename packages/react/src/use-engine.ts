// Hooks that follow the engine of a Canvas.
import type { DrawnAccuracy, EffectEntry, EngineMemory, SplatEngine } from '@websplatter/core';
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

const readAccuracy = (engine: SplatEngine) => engine.drawnAccuracy();
const readMemory = (engine: SplatEngine) => engine.memory();
const readEffects = (engine: SplatEngine) => engine.effects();

/** Returns the result of `read`, always the same function, on the engine. */
function useEngine<Found>(
  read: (engine: SplatEngine) => Found,
  renderer: object | undefined,
  who: string,
): Found | null {
  const measured = useMeasuredRenderer(renderer, who);
  const engine = splatEngineOf(measured);
  const [found, setFound] = useState<Found | null>(null);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    let latest: Found | null = null;
    const look = () => {
      timer = undefined;
      const now = read(engine);
      if (isSameValue(latest, now)) return;
      latest = now;
      setFound(now);
    };
    look();
    const stop = onStageTimings(measured, () => {
      timer ??= setTimeout(look, LOOK_AFTER_MS);
    });
    return () => {
      stop();
      clearTimeout(timer);
    };
  }, [measured, engine, read]);
  return found;
}
