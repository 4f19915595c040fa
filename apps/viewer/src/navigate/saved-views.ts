import type { ViewCamera } from '../camera/view-camera.ts';
import type { KeptView, SavedView } from '../state/saved-view.ts';
import type { ViewerStore } from '../state/store.ts';
import { MAX_SAVED_VIEWS } from './view-list.ts';
import { pathMs, pathThrough, placeOnPath, poseOnPath } from './view-path.ts';

export interface SavedViewsOptions {
  readonly store: ViewerStore;
  readonly camera: ViewCamera;
  /** Draws a small JPEG image, base64, of a view of the scene; null if there is no frame. */
  readonly draw: (view: KeptView) => Promise<string | null>;
}

/** The views that a person has saved of the scene on the screen, shown one by one or as a path. */
export class SavedViews {
  readonly #options: SavedViewsOptions;
  /** How long the path has been followed. */
  #elapsedMs = 0;

  constructor(options: SavedViewsOptions) {
    this.#options = options;
  }

  /** Ends the path with its scene; returns a function to stop this. Paths play on. */
  watch(): () => void {
    const { store, camera } = this.#options;
    const end = () => {
      camera.endPath();
      this.#elapsedMs = 0;
    };
    return store.subscribe(({ scene }) => scene?.title, end);
  }

  /** Saves the view on the screen. */
  async save(): Promise<void> {
    const { store, camera, draw } = this.#options;
    const { scene } = store.getState();
    const view = camera.keptView;
    // The device may be lost meanwhile; the viewer tells of that.
    const thumbnail = await draw(view).catch(() => null);
    const { savedViews, scene: sceneNow } = store.getState();
    if (thumbnail === null || sceneNow?.title !== scene?.title) return;
    if (savedViews.length >= MAX_SAVED_VIEWS) {
      store.setState({
        notice: `No more than ${MAX_SAVED_VIEWS} views of a scene are kept. Remove one first.`,
      });
      return;
    }
    store.setState({ savedViews: [...savedViews, { ...view, name: '', thumbnail }] });
  }

  /** Draws the small image of a view that came without one. */
  async complete(view: SavedView): Promise<void> {
    const thumbnail = await this.#options.draw(view).catch(() => null);
    if (thumbnail !== null) this.#replace(view, { thumbnail });
  }

  rename(view: SavedView, name: string): void {
    this.#replace(view, { name });
  }

  remove(view: SavedView): void {
    const { store, camera } = this.#options;
    camera.endPath();
    store.setState(({ savedViews }) => ({
      savedViews: savedViews.filter((each) => each !== view),
    }));
  }

  /** Follows the path through all views of the first one's way up, on from where it paused. */
  play(): void {
    const { store, camera } = this.#options;
    const path = pathThrough(store.getState().savedViews);
    const [first] = path;
    if (!first) return;
    const poses = path.map(({ pose }) => pose);
    const endMs = pathMs(poses.length);
    if (this.#elapsedMs >= endMs) this.#elapsedMs = 0;
    camera.lookAs(first);
    store.setState({ isPathPlaying: true });
    let shown = camera.controls.pose;
    camera.setMotion((elapsedMs) => {
      // A person who takes hold of the image wants to look around.
      if (camera.controls.pose !== shown || this.#elapsedMs >= endMs) {
        camera.endPath();
        return false;
      }
      this.#elapsedMs = Math.min(endMs, this.#elapsedMs + elapsedMs);
      const place = placeOnPath(this.#elapsedMs, poses.length);
      // Without motion, one view after the other.
      shown = camera.isMotionReduced ? poses[Math.floor(place)] : poseOnPath(poses, place);
      camera.controls.moveTo(shown);
      return true;
    });
  }

  #replace(view: SavedView, change: Partial<SavedView>): void {
    this.#options.store.setState(({ savedViews }) => ({
      savedViews: savedViews.map((each) => (each === view ? { ...each, ...change } : each)),
    }));
  }
}
