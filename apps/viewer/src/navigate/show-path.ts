import type { ViewerStore } from '../state/store.ts';

/** Small windows have room for the strip or for a panel; as in `dock.css`. */
const SMALL_WINDOW = '(max-width: 640px), (max-height: 480px)';

/** Shows the strip with the camera path, or hides it. */
export function showPath(store: ViewerStore, isPathVisible: boolean): void {
  store.setState(({ dock }) => ({
    isPathVisible,
    dock: isPathVisible && matchMedia(SMALL_WINDOW).matches ? null : dock,
  }));
}
