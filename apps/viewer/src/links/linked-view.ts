import type { ViewerState } from '../state/viewer-state.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { LinkedView } from './page-address.ts';

/** What an address has to tell so that what is shown now is shown again. */
export function linkedViewOf(viewer: Viewer, state: ViewerState): LinkedView {
  const { wish, accuracy, comparison, splitPart, requested, viewMode } = state;
  return {
    source: viewer.scenes.newest?.source ?? null,
    camera: viewer.camera.snapshot(),
    accuracy: wish ?? accuracy,
    comparison: comparison && { comparison, splitPart },
    effects: requested.choices,
    viewMode,
  };
}
