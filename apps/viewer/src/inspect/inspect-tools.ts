import type { Viewer } from '../engine/viewer.ts';
import type { Inspecting } from '../state/inspecting.ts';
import type { ViewerStore } from '../state/store.ts';
import type { SceneReader } from './scene-reader.ts';

/** Everything that the parts of the panel work with. */
export interface InspectTools {
  readonly store: ViewerStore;
  readonly viewer: Pick<Viewer, 'pickAt' | 'shownFrame' | 'setEffects' | 'scenes' | 'camera'>;
  readonly reader: Pick<SceneReader, 'ask'>;
  /** Changes the inspection. */
  readonly update: (change: Partial<Inspecting>) => void;
}
