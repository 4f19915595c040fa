import { callListener, type FrameStatistics } from '@websplatter/core';
import { onStageTimings } from '@websplatter/three';
import { useEffect, useMemo } from 'react';
import { useLatest } from './stable-values.ts';
import { useMeasuredRenderer } from './use-renderer.ts';

/** The newest measurement of a renderer. It can be read at any time and never causes a render. */
export interface StageTimingsSource {
  /** Null until a frame has been measured. */
  readonly current: FrameStatistics | null;
  /** Calls `listener` for each measured frame, until the returned function is called. */
  subscribe(listener: (statistics: FrameStatistics) => void): () => void;
}

/**
 * Reports the times of each frame's stages, some frames after it was drawn. This causes no render:
 * pass a `listener`, or use `current` and `subscribe` of the result.
 *
 * @param renderer needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null or
 *   undefined until then.
 * @throws InvalidArgumentError outside of a Canvas without `renderer`.
 * @example
 * function Timings() {
 *   useStageTimings(({ timing }) => console.log(`${timing.totalMs} ms`));
 *   return null;
 * }
 */
export function useStageTimings(
  ...[listener, ...renderer]: [listener?: (statistics: FrameStatistics) => void, renderer?: object | null]
): StageTimingsSource {
  const measured = useMeasuredRenderer(renderer, 'useStageTimings');
  const latest = useLatest(listener);
  const source = useMemo(() => {
    const subscribe = (each: (statistics: FrameStatistics) => void) =>
      measured ? onStageTimings(measured, each) : () => {};
    return { current: null as FrameStatistics | null, subscribe };
  }, [measured]);
  useEffect(
    () =>
      source.subscribe((statistics) => {
        source.current = statistics;
        callListener(latest.current, statistics);
      }),
    [source, latest],
  );
  return source;
}
