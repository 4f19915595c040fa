import { InvalidArgumentError, isAccuracyTarget } from '@websplatter/core';
import { followLinkedEffects } from '../effects/linked-effects.ts';
import { linkedStart } from '../engine/link/linked-start.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { EditHistory } from '../inspect/edit-history.ts';
import type { Edit } from '../state/history.ts';
import type { Crop, Inspecting } from '../state/inspecting.ts';
import { SCENE_LINK_FIELDS } from '../state/scene-link-fields.ts';
import type { ViewerStore } from '../state/store.ts';
import { type KeptWork, withKeys } from './kept-work.ts';

const { crop: CROP } = SCENE_LINK_FIELDS;

/**
 * Gives the scene on the screen what was made of it before, as one edit. The camera, the look and
 * the accuracy follow, too; saved views and annotations stay as they are.
 *
 * @param name of the edit, as in "Undo restored edits".
 * @param keys of the scene's files, in the order in which they were kept; undefined for missing ones.
 * @param beside what the edit changes besides.
 */
export function giveWork(
  panel: PanelProps,
  { view, rulers, scale, removed }: KeptWork,
  name: string,
  keys: readonly (number | undefined)[],
  beside?: Pick<Edit, 'do' | 'undo'>,
): void {
  const { store, viewer } = panel;
  const query = new URLSearchParams(view);
  const { accuracy, camera, comparison, viewMode, background, detail, notice } = linkedStart(query);
  const update = (change: Partial<Inspecting>) =>
    store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, ...change } }));
  store.setState({ viewMode, ...comparison, ...(detail && { detail, isDetailChosen: true }) });
  if (notice !== null) store.setState({ notice });
  if (accuracy && isAccuracyTarget(accuracy)) viewer.setTarget(accuracy);
  else if (accuracy) viewer.setAccuracy(accuracy);
  if (camera) viewer.camera.showLinked(camera);
  if (background) viewer.camera.setLook({ background });
  const crop = cropIn(query, store);
  // The crop is part of the edit.
  query.delete(CROP.name);
  followLinkedEffects(panel, query, () => true);
  if (scale) update({ scale });
  const edited = {
    crop,
    rulers: rulers.map((ends, id) => ({ id, ends })),
    removed: withKeys(removed, (place) => keys[Number(place)]),
  };
  new EditHistory({ store, viewer, update }).edit(name, edited, null, beside);
}

/** Null without a crop, or with one that cannot be read, which the store then says. */
function cropIn(query: URLSearchParams, store: ViewerStore): Crop | null {
  const text = query.get(CROP.name);
  try {
    return text === null ? null : CROP.decode(text);
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    store.setState({ notice: error.message });
    return null;
  }
}
