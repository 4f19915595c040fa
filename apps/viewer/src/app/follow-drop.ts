import { noteOpenedFile } from '../engine/keep/opened-file.ts';
import type { FileDropDecision } from '../engine/open/file-drop.ts';
import type { SceneSource } from '../engine/open/scene-source.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';
import { withCode } from '../ui/lazy.tsx';

/**
 * Opens dropped or chosen files or a project, applies a settings file among them, remembers the files for the
 * next visit, and reports files that are not opened.
 */
export function followDrop(
  { opened, notice, settings, project, isAdded = false, handles = [] }: FileDropDecision,
  store: ViewerStore,
  viewer: Viewer,
): void {
  // Settings dropped together with files that replace the scene do not apply to the old scene.
  const replaced = opened.length > 0 && !isAdded ? store.getState().scene : null;
  if (opened.length > 0) {
    const sources = opened.map((files): SceneSource => ({ kind: 'file', ...files }));
    if (isAdded) viewer.scenes.add(...sources);
    else viewer.scenes.open(...sources);
    viewer.files.remember({ names: opened.map(({ name }) => name), handles }, isAdded);
    noteOpenedFile();
    if (store.getState().dock === 'open') store.setState({ dock: null });
  }
  if (project)
    void withCode(
      store,
      () => import('../project/open-project.ts'),
      ({ openProject }) => void openProject(project, { store, viewer }),
    );
  if (settings)
    void withCode(
      store,
      () => import('../share/follow-settings.ts'),
      ({ followDroppedSettings }) => followDroppedSettings(settings, replaced, store, viewer),
    );
  if (notice) store.setState({ notice });
}
