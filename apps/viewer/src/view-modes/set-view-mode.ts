import { editPicture } from '../engine/edit-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import type { ViewModeName } from '../state/view-mode.ts';

/** Modes in a row, looked through one after the other, are undone together. */
const LOOKING_THROUGH = {};

/** Shows a view mode, as a person has asked. */
export function setViewMode(panel: PanelProps, viewMode: ViewModeName): void {
  editPicture(panel, 'view mode', () => panel.store.setState({ viewMode }), LOOKING_THROUGH);
}
