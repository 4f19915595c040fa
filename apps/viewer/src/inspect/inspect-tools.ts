import type { Viewer } from '../engine/viewer.ts';
import type { SceneLook } from '../scene/inspect-messages.ts';
import type { Inspecting } from '../state/inspecting.ts';
import type { ViewerStore } from '../state/store.ts';
import type { SceneReader } from './scene-reader.ts';

/** Services shared by the panel's parts. */
export interface InspectTools {
  readonly store: ViewerStore;
  readonly viewer: Pick<Viewer, 'pickAt' | 'askShown' | 'shownFrame' | 'setEffects' | 'scenes' | 'camera'>;
  readonly reader: Pick<SceneReader, 'ask'>;
  /** Changes the inspection. */
  readonly update: (change: Partial<Inspecting>) => void;
}

/** The camera of the frame on the screen; null before there is one. */
export function shownLook({ viewer }: Pick<InspectTools, 'viewer'>): SceneLook | null {
  const { shownFrame } = viewer;
  if (!shownFrame) return null;
  const { frame, isFlipped } = shownFrame;
  const { camera } = frame;
  const viewMatrix = Array.from(camera.viewMatrix);
  const projectionMatrix = Array.from(camera.projectionMatrix);
  return { viewMatrix, projectionMatrix, isFlipped };
}
