import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { RunCommand } from './command-list.ts';

/**
 * Fetches the code for gamepads when the first is connected, since few visitors have one; returns a
 * function that stops this.
 */
export function listenForGamepads(viewer: Viewer, store: ViewerStore, run: RunCommand): () => void {
  const ending = new AbortController();
  const { signal } = ending;
  const follow = async () => {
    const { followGamepads } = await import('../navigation/gamepads.ts');
    if (!signal.aborted) signal.addEventListener('abort', followGamepads(viewer, store, run));
  };
  window.addEventListener('gamepadconnected', () => void follow(), { once: true, signal });
  return () => ending.abort();
}
