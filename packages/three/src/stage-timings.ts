import type { FrameStatistics } from '@websplatter/core';

type Listener = (statistics: FrameStatistics) => void;

const listenersOf = new WeakMap<object, Set<Listener>>();

/**
 * Calls `listener` with the cost of each measured frame of splats, some frames after it was drawn.
 * If a renderer draws several views, each view's frames are reported.
 *
 * @returns a function that stops listening.
 */
export function onStageTimings(renderer: object, listener: Listener): () => void {
  let listeners = listenersOf.get(renderer);
  if (!listeners) {
    listeners = new Set();
    listenersOf.set(renderer, listeners);
  }
  listeners.add(listener);
  return () => listeners.delete(listener);
}

export function reportStageTimings(renderer: object, statistics: FrameStatistics): void {
  for (const listener of [...(listenersOf.get(renderer) ?? [])]) listener(statistics);
}
