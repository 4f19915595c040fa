import type { ViewerStore } from '../state/store.ts';
import { fetchLazy } from '../ui/lazy.tsx';

/**
 * Fetches the code that the first picture does without, once a scene is on the screen as a whole
 * and the page is idle.
 */
export function fetchLateWhenIdle(store: ViewerStore): void {
  const unsubscribe = store.subscribe(({ imageId }) => {
    if (imageId === 0) return;
    unsubscribe();
    // Not all browsers say when they are.
    if ('requestIdleCallback' in window) requestIdleCallback(() => void fetchLazy());
    else setTimeout(fetchLazy);
  });
}
