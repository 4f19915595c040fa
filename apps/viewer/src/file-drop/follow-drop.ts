import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { FileDropDecision } from './file-drop.ts';

/** Opens what was dropped or chosen, and says what was not. */
export function followDrop({ opened, notice }: FileDropDecision, store: ViewerStore, viewer: Viewer): void {
  if (opened) viewer.scenes.open({ kind: 'file', ...opened });
  if (notice) store.setState({ notice });
}
