import type { ViewerStore } from '../../state/store.ts';
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
    store.setState({
      lastFile: null,
      failure: {
        title: `${name} cannot be opened again`,
        message: error instanceof Error ? error.message : String(error),
        advice: 'It may have been moved, renamed or removed. Open it from where it is now.',
        isFault: false,
      },
    });
  }
  return null;
}
