import { upAxisOf } from '../camera/up-axis.ts';
import type { ViewCamera } from '../camera/view-camera.ts';
import type { SavedView } from '../state/saved-view.ts';
import type { ViewerStore } from '../state/store.ts';
import { MAX_SAVED_VIEWS, viewListKey } from './view-list.ts';
import { PATH_STEP_MS, pathThrough, poseOnPath } from './view-path.ts';
import { type ViewStorage, watchViewList } from './watch-view-list.ts';

export interface SavedViewsOptions {
  readonly store: ViewerStore;
  readonly camera: ViewCamera;
  /** Draws a small JPEG image, base64, of the frame on the screen; null if there is none. */
  readonly draw: () => Promise<string | null>;
  readonly storage: ViewStorage;
}

/**
 * The views that a person has saved of the scene on the screen: kept in the browser by the scene's
 * name, shown one by one or as a path.
 */
export class SavedViews {
  readonly #options: SavedViewsOptions;
  /** How far the path has been followed, in views. */
  #at = 0;

  constructor(options: SavedViewsOptions) {
    this.#options = options;
  }

  /** Keeps the list in step with the scene; returns a function to stop this. Paths play on. */
  watch(): () => void {
    const { store, storage } = this.#options;
    return watchViewList(store, storage, () => {
      this.pause();
      this.#at = 0;
    });
  }

  /** Saves the view on the screen. */
  async save(): Promise<void> {
    const { store, camera, draw } = this.#options;
    const { scene, look, isFlipped, isZUp } = store.getState();
    const { pose } = camera.controls;
    // The device may be lost meanwhile; the viewer tells of that.
    const thumbnail = await draw().catch(() => null);
    const { savedViews, scene: sceneNow } = store.getState();
    if (thumbnail === null || sceneNow?.title !== scene?.title) return;
    if (savedViews.length >= MAX_SAVED_VIEWS) {
      store.setState({
        notice: `No more than ${MAX_SAVED_VIEWS} views of a scene are kept. Remove one first.`,
      });
      return;
    }
    const { fovDegrees, isOrthographic } = look;
    this.#take([...savedViews, { pose, fovDegrees, isOrthographic, isFlipped, isZUp, thumbnail }]);
  }

  remove(view: SavedView): void {
    this.pause();
    this.#take(this.#options.store.getState().savedViews.filter((each) => each !== view));
  }

  /** Goes to a view. */
  show(view: SavedView): void {
    this.pause();
    this.#prepare(view);
    this.#options.camera.controls.glideTo(view.pose);
  }

  /** Follows the path through all views of the first one's way up, on from where it paused. */
  play(): void {
    const { store, camera } = this.#options;
    const path = pathThrough(store.getState().savedViews);
    const [first] = path;
    if (!first) return;
    const poses = path.map(({ pose }) => pose);
    const end = poses.length - 1;
    if (this.#at >= end) this.#at = 0;
    this.#prepare(first);
    store.setState({ isPathPlaying: true });
    let shown = camera.controls.pose;
    camera.setMotion((elapsedMs) => {
      // A person who takes hold of the image wants to look around.
      if (camera.controls.pose !== shown || this.#at >= end) {
        this.pause();
        return false;
      }
      this.#at = Math.min(end, this.#at + elapsedMs / PATH_STEP_MS);
      shown = poseOnPath(poses, this.#at);
      camera.controls.moveTo(shown);
      return true;
    });
  }

  pause(): void {
    const { store, camera } = this.#options;
    if (!store.getState().isPathPlaying) return;
    store.setState({ isPathPlaying: false });
    camera.setMotion(null);
  }

  /** Looks as in `view`, but from where the camera is. */
  #prepare(view: SavedView): void {
    const { store, camera } = this.#options;
    const { fovDegrees, isOrthographic } = view;
    if (upAxisOf(view) !== upAxisOf(store.getState())) camera.setUpAxis(upAxisOf(view));
    camera.setLook({ fovDegrees, isOrthographic });
  }

  #take(savedViews: readonly SavedView[]): void {
    const { store, storage } = this.#options;
    store.setState({ savedViews });
    const title = store.getState().scene?.title;
    if (title === undefined) return;
    try {
      if (savedViews.length === 0) storage().removeItem(viewListKey(title));
      else storage().setItem(viewListKey(title), JSON.stringify(savedViews));
    } catch {
      store.setState({
        notice: 'The browser has no room for this view: it is gone when the page is closed.',
      });
    }
  }
}
