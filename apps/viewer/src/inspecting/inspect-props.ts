import type { ViewerStore } from '../state/store.ts';
import type { Inspection } from './inspection.ts';

/** What each part of the panel shows, and what it calls. */
export interface InspectProps {
  readonly store: ViewerStore;
  readonly inspection: Inspection;
}
