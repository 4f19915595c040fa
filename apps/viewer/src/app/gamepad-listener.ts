import type { Viewer } from '../engine/viewer.ts';
import type { RunCommand } from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';

/**
 * Fetches the code for gamepads when the first one is connected: few visitors have one. Returns a
 * function that stops this.
 */
export function listenForGamepads(viewer: Viewer, store: ViewerStore, run: RunCommand): () => void {
  const ending = new AbortController();
  const { signal } = ending;
  const follow = async () => {
    const { followGamepads } = await import('../navigate/gamepads.ts');
    if (!signal.aborted) signal.addEventListener('abort', followGamepads(viewer, store, run));
  };
  window.addEventListener('gamepadconnected', () => void follow(), { once: true, signal });
  return () => ending.abort();
}
