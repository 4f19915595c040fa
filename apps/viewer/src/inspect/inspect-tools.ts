import type { Viewer } from '../engine/viewer.ts';
import type { Look } from '../scene/inspect-messages.ts';
import type { Inspecting } from '../state/inspecting.ts';
import type { ViewerStore } from '../state/store.ts';
import type { SceneReader } from './scene-reader.ts';

/** Services shared by the panel's parts. */
export interface InspectTools {
  readonly store: ViewerStore;
  readonly viewer: Pick<Viewer, 'pickAt' | 'shownFrame' | 'setEffects' | 'scenes' | 'camera'>;
  readonly reader: Pick<SceneReader, 'ask'>;
  /** Changes the inspection. */
  readonly update: (change: Partial<Inspecting>) => void;
}

/** The camera of the current image; null before there is one. */
export function shownLook({ store, viewer }: Pick<InspectTools, 'store' | 'viewer'>): Look | null {
  const camera = viewer.shownFrame?.frame.camera;
  if (!camera) return null;
  const { isFlipped } = store.getState();
  const viewMatrix = Array.from(camera.viewMatrix);
  const projectionMatrix = Array.from(camera.projectionMatrix);
  return { viewMatrix, projectionMatrix, isFlipped };
}
