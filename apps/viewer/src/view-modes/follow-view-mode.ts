import type { Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';

/**
 * Fetches the code that draws view modes when a mode first needs it, then draws with it.
 *
 * @param fetchCode for tests.
 */
export function followViewMode(
  store: ViewerStore,
  viewer: Viewer,
  fetchCode = () => import('./apply-view-mode.ts'),
): void {
  let isFetched = false;
  const follow = async () => {
    if (isFetched || store.getState().viewMode === 'colours') return;
    isFetched = true;
    try {
      const { applyViewMode } = await fetchCode();
      applyViewMode(store, viewer);
    } catch (error) {
      console.error(error);
      isFetched = false;
      const notice = 'The view mode could not be fetched, so the picture shows colours. Try again later.';
      store.setState({ viewMode: 'colours', notice });
    }
  };
  void follow();
  store.subscribe(({ viewMode }) => viewMode, follow);
}
