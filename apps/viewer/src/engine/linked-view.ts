import type { ViewerState } from '../state/store.ts';
import type { LinkedView } from './page-address.ts';
import { PLACE_FIELD } from './place-link.ts';
import { ownUp, type ShownPart } from './shown-scene.ts';
import type { Viewer } from './viewer.ts';

/** Contents of an address that shows the present view again. */
export function linkedViewOf(viewer: Viewer, state: ViewerState): LinkedView {
  const { target, accuracy, comparison, splitPart, requested, inspecting } = state;
  const parts = viewer.scenes.newest?.parts ?? [];
  return {
    sources: parts.map(({ source }) => source),
    looks: looksOf(parts),
    camera: viewer.camera.snapshot(),
    accuracy: target ?? accuracy,
    detail: state.isDetailChosen ? state.detail : null,
    comparison: comparison && { comparison, splitPart },
    effects: requested.text,
    crop: inspecting.crop,
    viewMode: state.viewMode,
    background: state.look.background,
    savedViews: state.savedViews,
    path: state.path,
    annotations: state.annotating.list,
  };
}

/** None where all files are drawn as they come when they are opened together. */
function looksOf(parts: readonly ShownPart[]): readonly string[] {
  const looks = parts.map(({ look }) => PLACE_FIELD.encode(look));
  // Files that have another way up than the first are turned by themselves.
  const areAllAlike = new Set(parts.map(({ loaded }) => ownUp(loaded))).size < 2;
  return areAllAlike && looks.every((look) => look === '') ? [] : looks;
}
