import type { SceneSource } from '../scene/scene-source.ts';
import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { FileDropDecision } from './file-drop.ts';

/** Opens what was dropped or chosen, keeps it to be offered again, shows it as the settings beside it say, and says what is not opened. */
export function followDrop(
  { opened, notice, settings, isAdded = false, handles = [] }: FileDropDecision,
  store: ViewerStore,
  viewer: Viewer,
): void {
  // What is dropped with files that take its place is not meant for what is shown.
  const replaced = opened.length > 0 && !isAdded ? store.getState().scene : null;
  if (opened.length > 0) {
    const sources = opened.map((files): SceneSource => ({ kind: 'file', ...files }));
    if (isAdded) viewer.scenes.add(...sources);
    else viewer.scenes.open(...sources);
    viewer.files.remember({ names: opened.map(({ name }) => name), handles }, isAdded);
    // Kept by this entry of the history, so that a reload offers the file whatever else the address asks for.
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
