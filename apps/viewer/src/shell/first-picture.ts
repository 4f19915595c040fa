import type { ViewerStore } from '../state/store.ts';
import { fetchLate } from '../ui/late.tsx';

/** Name of the time from the navigation to the first picture of a whole scene, among the page's `performance` entries. */
export const FIRST_PICTURE = 'first picture';

/** Once a whole scene is on the screen: notes how long that took, and has the code fetched that could wait for it. */
export function followFirstPicture(store: ViewerStore): void {
  const unsubscribe = store.subscribe(({ imageId }) => {
    if (imageId === 0) return;
    unsubscribe();
    performance.measure(FIRST_PICTURE);
    whenIdle(() => void fetchLate());
  });
}

/** Not all browsers say when they are. */
function whenIdle(work: () => void): void {
  if ('requestIdleCallback' in window) requestIdleCallback(work);
  else setTimeout(work);
}
