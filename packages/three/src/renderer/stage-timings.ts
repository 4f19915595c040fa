import { type FrameStatistics, Listeners } from '@websplatter/core';

type Listener = (statistics: FrameStatistics) => void;

const listenersOf = new WeakMap<object, Listeners<[FrameStatistics]>>();

/**
 * Calls `listener` with the cost of each measured frame of splats, some frames after it was drawn.
 * If a renderer draws several views, each view's frames are reported.
 *
 * @returns a function that stops listening.
 * @example
 * const stop = onStageTimings(renderer, ({ timing }) => console.log(timing.totalMs));
 */
export function onStageTimings(renderer: object, listener: Listener): () => void {
  let listeners = listenersOf.get(renderer);
  if (!listeners) {
    listeners = new Listeners();
    listenersOf.set(renderer, listeners);
  }
  return listeners.add(listener);
}

export function reportStageTimings(renderer: object, statistics: FrameStatistics): void {
  listenersOf.get(renderer)?.call(statistics);
}
