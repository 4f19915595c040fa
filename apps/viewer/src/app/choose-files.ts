import { decide } from '../engine/open/decide.ts';
import { filesOf, pickHandles } from '../engine/open/file-handles.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';
import { followDrop } from './follow-drop.ts';

/** Uses the picker that returns handles, if the browser has one. */
export async function chooseFiles(
  viewer: Viewer,
  store: ViewerStore,
  input: HTMLInputElement | null,
  isAdded: boolean,
): Promise<void> {
  const handles = await pickHandles();
  if (handles === null) input?.click();
  if (!handles?.length) return;
  const found = await filesOf(handles);
  if (found) followDrop({ ...(await decide(found)), isAdded, handles }, store, viewer);
}
