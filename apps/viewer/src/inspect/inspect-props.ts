import type { ViewerStore } from '../state/store.ts';
import type { Inspection } from './inspection.ts';

/** Props of each part of the panel: data, and calls. */
export interface InspectProps {
  readonly store: ViewerStore;
  readonly inspection: Inspection;
}
