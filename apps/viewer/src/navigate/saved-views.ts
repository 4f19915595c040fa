import type { ViewCamera } from '../camera/view-camera.ts';
import { makeEdit, replacement } from '../state/make-edit.ts';
import type { KeptView, SavedView } from '../state/saved-view.ts';
import type { ViewerStore } from '../state/store.ts';
import { MAX_SAVED_VIEWS } from './view-list.ts';
import { pathMs, pathThrough, placeOnPath, poseOnPath } from './view-path.ts';

export interface SavedViewsOptions {
  readonly store: ViewerStore;
  readonly camera: ViewCamera;
  /** Draws a thumbnail of a view as a base64 JPEG; null if there is no frame. */
  readonly draw: (view: KeptView) => Promise<string | null>;
}

/** The saved views of the current scene, shown one by one or as a path. */
export class SavedViews {
  readonly #options: SavedViewsOptions;
  /** Time since the path began. */
  #elapsedMs = 0;

  constructor(options: SavedViewsOptions) {
    this.#options = options;
  }

  /**
   * Ends the path when its scene changes; returns a function that stops watching. Paths play on.
   */
  watch(): () => void {
    const { store, camera } = this.#options;
    const end = () => {
      camera.endPath();
      this.#elapsedMs = 0;
    };
    return store.subscribe(({ scene }) => scene?.contentKey, end);
  }

  /** Saves the view on the screen. */
  async save(): Promise<void> {
    const { store, camera, draw } = this.#options;
    const { scene } = store.getState();
    const view = camera.keptView;
    // The device may be lost meanwhile, which the viewer reports.
    const thumbnail = await draw(view).catch(() => null);
    const { savedViews, scene: sceneNow } = store.getState();
    if (thumbnail === null || sceneNow?.contentKey !== scene?.contentKey) return;
    if (savedViews.length >= MAX_SAVED_VIEWS) {
      store.setState({
        notice: `No more than ${MAX_SAVED_VIEWS} views of a scene are kept. Remove one first.`,
      });
      return;
    }
    this.#edit('saved view', [...savedViews, { ...view, name: '', thumbnail }]);
  }

  /** Draws the missing thumbnail of a view. */
  async complete(view: SavedView): Promise<void> {
    const thumbnail = await this.#options.draw(view).catch(() => null);
    if (thumbnail !== null) this.#options.store.setState({ savedViews: this.#replaced(view, { thumbnail }) });
  }

  /** @param gesture successive names of one gesture, such as typing, are undone together. */
  rename(view: SavedView, name: string, gesture: unknown): void {
    this.#edit('name of a view', this.#replaced(view, { name }), gesture);
  }

  remove(view: SavedView): void {
    const { store, camera } = this.#options;
    camera.endPath();
    this.#edit(
      'removal of a view',
      store.getState().savedViews.filter((each) => each !== view),
    );
    store.setState({
      notice: { text: 'The view is removed.', offers: [{ label: 'Undo', command: 'undo' }] },
    });
  }

  /** Plays the path through all views with the first one's way up, continuing from a pause. */
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
      // A user who moves the image wants to look around.
      if (camera.controls.pose !== shown || this.#elapsedMs >= endMs) {
        camera.endPath();
        return false;
      }
      this.#elapsedMs = Math.min(endMs, this.#elapsedMs + elapsedMs);
      const place = placeOnPath(this.#elapsedMs, poses.length);
      // With reduced motion, the views follow one another without a transition.
      shown = camera.isMotionReduced ? poses[Math.floor(place)] : poseOnPath(poses, place);
      camera.controls.moveTo(shown);
      return true;
    });
  }

  #replaced(view: SavedView, change: Partial<SavedView>): readonly SavedView[] {
    const { savedViews } = this.#options.store.getState();
    return savedViews.map((each) => (each === view ? { ...each, ...change } : each));
  }

  #edit(name: string, next: readonly SavedView[], gesture: unknown = null): void {
    const { store } = this.#options;
    const now = () => store.getState().savedViews;
    makeEdit(
      store,
      replacement(name, next, now, (savedViews) => store.setState({ savedViews })),
      gesture,
    );
  }
}
