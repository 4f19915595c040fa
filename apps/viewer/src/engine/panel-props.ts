import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from './viewer.ts';

/** Panels read the store and call the viewer's commands. */
export interface PanelProps {
  readonly store: ViewerStore;
  readonly viewer: Viewer;
}
