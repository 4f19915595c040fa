import type { ViewCamera } from '../camera/view-camera.ts';
import { makeEdit, replacement } from '../state/make-edit.ts';
import { type KeptView, LEAST_STEP_MS, type SavedView, USUAL_STEP_MS } from '../state/saved-view.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import { clamp } from '../state/vec3.ts';
import { MAX_SAVED_VIEWS } from './view-list.ts';
import { type CameraPath, keyAt, pathOf, turntableViews, viewOnPath } from './view-path.ts';

export interface SavedViewsOptions {
  readonly store: ViewerStore;
  readonly camera: ViewCamera;
  /** Draws a thumbnail of a view as a base64 JPEG; null if there is no frame. */
  readonly draw: (view: KeptView) => Promise<string | null>;
}

/** Longest time from one view to the next, ms: an hour. */
const MOST_STEP_MS = 3_600_000;
/** Duration of a turntable unless a person sets another, ms. */
export const TURNTABLE_MS = 10_000;

/** The saved views of the current scene, shown one by one or as a path. */
export class SavedViews {
  readonly #options: SavedViewsOptions;

  constructor(options: SavedViewsOptions) {
    this.#options = options;
  }

  /** Saves the view on the screen. */
  async save(): Promise<void> {
    const { store, camera } = this.#options;
    const view = camera.keptView;
    const thumbnail = await this.#draw(view);
    if (thumbnail === null) return;
    const { savedViews } = store.getState();
    if (savedViews.length >= MAX_SAVED_VIEWS) {
      store.setState({
        notice: `No more than ${MAX_SAVED_VIEWS} views of a scene are kept. Remove one first.`,
      });
      return;
    }
    this.#edit('saved view', { savedViews: [...savedViews, { ...view, name: '', thumbnail }] });
  }

  /** Shows what is on the screen in the place of a saved view. */
  async overwrite(view: SavedView): Promise<void> {
    const shown = this.#options.camera.keptView;
    const thumbnail = await this.#draw(shown);
    if (thumbnail !== null) this.#replace('replaced view', view, { ...shown, thumbnail });
  }

  /** Draws the missing thumbnail of a view. */
  async complete(view: SavedView): Promise<void> {
    const thumbnail = await this.#draw(view);
    const { store } = this.#options;
    if (thumbnail !== null) store.setState(withChange(store.getState(), view, { thumbnail }));
  }

  /** @param gesture successive names of one gesture, such as typing, are undone together. */
  rename(view: SavedView, name: string, gesture: unknown): void {
    this.#replace('name of a view', view, { name }, gesture);
  }

  /** Changes how the path goes on from a view. @param gesture as for `rename`. */
  setPassing(
    view: SavedView,
    change: Pick<SavedView, 'toNextMs' | 'passing'>,
    gesture: unknown = null,
  ): void {
    const { toNextMs } = change;
    const timed = toNextMs === undefined ? change : { ...change, toNextMs: steppedMs(toNextMs) };
    this.#replace('timing of a view', view, timed, gesture);
  }

  remove(view: SavedView): void {
    this.#options.camera.endPath();
    const { savedViews } = this.#options.store.getState();
    this.#edit('removal of a view', { savedViews: savedViews.filter((each) => each !== view) });
    this.#options.store.setState({
      notice: { text: 'The view is removed.', offers: [{ label: 'Undo', command: 'undo' }] },
    });
  }

  /** Exchanges a view with the one after it, or before it (−1); the times stay with the places. */
  shift(index: number, by: 1 | -1): void {
    const { savedViews } = this.#options.store.getState();
    const [here, there] = [savedViews[index], savedViews[index + by]];
    if (!here || !there) return;
    const moved = savedViews
      .with(index, { ...there, toNextMs: here.toNextMs })
      .with(index + by, { ...here, toNextMs: there.toNextMs });
    this.#edit('move of a view', { savedViews: moved });
  }

  /** Passes a view at another time, ms from the path's beginning: before others that are later. */
  moveTo(index: number, atMs: number): void {
    const { store } = this.#options;
    const { savedViews, path } = store.getState();
    const savedPath = pathOf({ savedViews, path: { ...path, turntable: null } });
    if (!savedPath) return;
    const places = savedPath.keys.map((key, i) => ({
      view: savedViews[i],
      atMs: i === index ? steppedMs(atMs, 0) : key.atMs,
    }));
    const ordered = places.toSorted((a, b) => a.atMs - b.atMs);
    // The way from the last view back to the first keeps its time, whichever is last now.
    const { toNextMs: lastMs } = savedViews[savedViews.length - 1];
    const views = ordered.map(({ view, atMs: fromMs }, i): SavedView => {
      const next = ordered[i + 1];
      return { ...view, toNextMs: next ? steppedMs(next.atMs - fromMs) : lastMs };
    });
    this.#edit('move of a view', { savedViews: views });
  }

  /** Puts views in the place of all, as those of a file; the path is the one through them. */
  replaceAll(savedViews: readonly SavedView[], isLooped: boolean): void {
    this.#options.camera.endPath();
    this.#options.store.setState({ playheadMs: 0 });
    this.#edit('import of a path', { savedViews, path: { isLooped, turntable: null } });
  }

  setLooped(isLooped: boolean): void {
    const { path } = this.#options.store.getState();
    this.#edit('loop of the path', { path: { ...path, isLooped } });
  }

  /** Makes a path once around what the present view looks at, or with null ends it. */
  setTurntable(durationMs: number | null): void {
    const { store, camera } = this.#options;
    const { path } = store.getState();
    camera.endPath();
    store.setState({ playheadMs: 0 });
    const ms = durationMs === null ? null : Math.max(4 * LEAST_STEP_MS, durationMs);
    const turntable = ms === null ? null : { view: camera.keptView, durationMs: ms };
    this.#edit('turntable', { path: { ...path, turntable } });
  }

  /** Gives the present turntable another duration. @param gesture as for `rename`. */
  setTurntableMs(durationMs: number, gesture: unknown): void {
    const { path } = this.#options.store.getState();
    if (!path.turntable) return;
    const turntable = { ...path.turntable, durationMs: Math.max(4 * LEAST_STEP_MS, durationMs) };
    this.#edit('turntable', { path: { ...path, turntable } }, gesture);
  }

  /** Appends the views of the turntable to the saved views, to be edited one by one. */
  keepTurntable(): void {
    const { savedViews, path } = this.#options.store.getState();
    if (!path.turntable || savedViews.length + 4 > MAX_SAVED_VIEWS) return;
    const views = turntableViews(path.turntable).map(
      ({ view, toNextMs }, i): SavedView => ({
        ...view,
        ...{ name: `Turntable ${90 * i}°`, thumbnail: null, toNextMs: steppedMs(toNextMs) },
      }),
    );
    this.#edit('turntable as views', {
      savedViews: [...savedViews, ...views],
      path: { isLooped: true, turntable: null },
    });
  }

  /** Plays the path, or pauses it if it is playing. */
  togglePlaying(): void {
    const { store, camera } = this.#options;
    if (store.getState().isPathPlaying) camera.endPath();
    else this.play();
  }

  /** Plays the path from the playhead, from its beginning if that is at the end. */
  play(): void {
    const { store, camera } = this.#options;
    const first = pathOf(store.getState());
    if (!first) return;
    const { playheadMs, scene } = store.getState();
    if (!first.isLooped && playheadMs >= first.durationMs) store.setState({ playheadMs: 0 });
    camera.lookAs(first.keys[0].view);
    store.setState({ isPathPlaying: true });
    let shown = camera.controls.pose;
    camera.setMotion((elapsedMs) => {
      const state = store.getState();
      // Its views may be edited while it plays.
      const path = pathOf(state);
      // A user who moves the image wants to look around.
      const isTaken = camera.controls.pose !== shown || state.scene?.contentKey !== scene?.contentKey;
      if (isTaken || !path || (!path.isLooped && state.playheadMs >= path.durationMs)) {
        camera.endPath();
        return false;
      }
      const timeMs = state.playheadMs + elapsedMs;
      const nextMs = path.isLooped ? timeMs % path.durationMs : Math.min(path.durationMs, timeMs);
      store.setState({ playheadMs: nextMs });
      shown = this.#show(path, nextMs);
      return true;
    });
  }

  /** Pauses, and shows the path at a time, ms. */
  scrub(timeMs: number): void {
    const { store, camera } = this.#options;
    const path = pathOf(store.getState());
    if (!path) return;
    camera.endPath();
    camera.lookAs(path.keys[0].view);
    const playheadMs = clamp(timeMs, 0, path.durationMs);
    store.setState({ playheadMs });
    // The end of a loop is its beginning, which would jump under the playhead.
    this.#show(path, playheadMs);
  }

  /** With reduced motion, the views follow one another without a transition. */
  #show(path: CameraPath, timeMs: number): KeptView['pose'] {
    const { store, camera } = this.#options;
    const key = path.keys[keyAt(path, timeMs)];
    const { pose, fovDegrees, isOrthographic } = viewOnPath(path, camera.isMotionReduced ? key.atMs : timeMs);
    const { look } = store.getState();
    if (look.fovDegrees !== fovDegrees || look.isOrthographic !== isOrthographic)
      camera.setLook({ fovDegrees, isOrthographic });
    camera.controls.moveTo(pose);
    return pose;
  }

  /** Null where there is nothing to draw, or another scene has come meanwhile. */
  async #draw(view: KeptView): Promise<string | null> {
    const { store, draw } = this.#options;
    const { scene } = store.getState();
    // The device may be lost meanwhile, which the viewer reports.
    const thumbnail = await draw(view).catch(() => null);
    return store.getState().scene?.contentKey === scene?.contentKey ? thumbnail : null;
  }

  #replace(name: string, view: SavedView, change: Partial<SavedView>, gesture: unknown = null): void {
    this.#edit(name, withChange(this.#options.store.getState(), view, change), gesture);
  }

  #edit(name: string, change: Partial<ViewsAndPath>, gesture: unknown = null): void {
    const { store } = this.#options;
    const now = (): ViewsAndPath => {
      const { savedViews, path } = store.getState();
      return { savedViews, path };
    };
    makeEdit(
      store,
      replacement(name, { ...now(), ...change }, now, (value) => store.setState(value)),
      gesture,
    );
  }
}

type ViewsAndPath = Pick<ViewerState, 'savedViews' | 'path'>;

function withChange(
  { savedViews }: Pick<ViewerState, 'savedViews'>,
  view: SavedView,
  change: Partial<SavedView>,
): Pick<ViewerState, 'savedViews'> {
  return { savedViews: savedViews.map((each) => (each === view ? { ...each, ...change } : each)) };
}

/** Rounded to the steps of times on a path. */
function steppedMs(timeMs: number, leastMs = LEAST_STEP_MS): number {
  return clamp(LEAST_STEP_MS * Math.round(timeMs / LEAST_STEP_MS), leastMs, MOST_STEP_MS);
}

/** Time from a saved view to the next one, ms. */
export function toNextMsOf({ toNextMs = USUAL_STEP_MS }: Pick<SavedView, 'toNextMs'>): number {
  return toNextMs;
}
