import type { SceneSource } from '../scene/scene-source.ts';
import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { FileDropDecision } from './file-drop.ts';

/**
 * Opens dropped or chosen files as the settings among them say, remembers them to be offered again,
 * and tells which stay unopened.
 */
export function followDrop(
  { opened, notice, settings, isAdded = false, handles = [] }: FileDropDecision,
  store: ViewerStore,
  viewer: Viewer,
): void {
  // Settings dropped with files that take the scene's place are not meant for the old scene.
  const replaced = opened.length > 0 && !isAdded ? store.getState().scene : null;
  if (opened.length > 0) {
    const sources = opened.map((files): SceneSource => ({ kind: 'file', ...files }));
    if (isAdded) viewer.scenes.add(...sources);
    else viewer.scenes.open(...sources);
    viewer.files.remember({ names: opened.map(({ name }) => name), handles }, isAdded);
    // Kept by this entry of the history: a reload offers the file under any address.
    history.replaceState({ ...history.state, [OPENED_FILE]: true }, '');
  }
  if (settings)
    void import('../supersplat/follow-settings.ts').then(({ followDroppedSettings }) =>
      followDroppedSettings(settings, replaced, store, viewer),
    );
  if (notice) store.setState({ notice });
}

const OPENED_FILE = 'openedFile';

/** Whether a file was opened here before the page was reloaded. */
export function hasOpenedFile(): boolean {
  return history.state?.[OPENED_FILE] === true;
}
