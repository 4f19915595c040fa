import type { ViewerStore } from '../../state/store.ts';
import { tellFailure } from '../../state/tell-failure.ts';
import { decideFiles } from '../open/decide-files.ts';
import type { AskedHandle, FileDropDecision } from '../open/file-drop.ts';
import { filesOf } from '../open/file-handles.ts';

/**
 * Reads the scene `name` that was opened before the page was reloaded; null, with the reason in
 * `store`, if that fails.
 */
export async function reopenFile(
  name: string,
  handles: readonly AskedHandle[],
  store: ViewerStore,
): Promise<FileDropDecision | null> {
  try {
    const found = await filesOf(handles);
    if (found) return { ...decideFiles(found), handles };
    store.setState({ notice: `The browser may not read ${name} without your permission.` });
  } catch (error) {
    store.setState({ lastFile: null });
    tellFailure(store, error, {
      title: `${name} cannot be opened again`,
      advice: 'It may have been moved, renamed or removed. Open it from where it is now.',
    });
  }
  return null;
}
