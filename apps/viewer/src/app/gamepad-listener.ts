import type { Viewer } from '../engine/viewer.ts';
import type { RunCommand } from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';
import { withCode } from '../ui/lazy.tsx';

/**
 * Fetches the code for gamepads when the first one is connected: few visitors have one. Returns a
 * function that stops this.
 */
export function listenForGamepads(viewer: Viewer, store: ViewerStore, run: RunCommand): () => void {
  const ending = new AbortController();
  const { signal } = ending;
  const follow = () =>
    void withCode(
      store,
      () => import('../navigate/gamepads.ts'),
      ({ followGamepads }) => {
        if (!signal.aborted) signal.addEventListener('abort', followGamepads(viewer, store, run));
      },
    );
  window.addEventListener('gamepadconnected', follow, { once: true, signal });
  return () => ending.abort();
}
