import { InvalidArgumentError } from '@websplatter/core';
import { canLink, isFallback } from '../engine/page-address.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import { scenePlaceOf } from '../engine/scene-place.ts';
import type { SceneSource } from '../engine/scene-source.ts';
import { drawCrop } from '../inspect/draw-crop.ts';
import { firstValues } from '../state/effect-values.ts';
import type { EffectChoices } from '../state/effects.ts';
import type { Crop } from '../state/inspecting.ts';
import { SCENE_LINK_FIELDS } from '../state/scene-link-fields.ts';
import { chooseEffects } from './choose-effects.ts';
import { EFFECTS_FIELD } from './effects-link.ts';

/**
 * Draws the first scene with the effects and the crop of the address, unless it is another scene
 * than the address names: lengths would be those of another scene. Unreadable parts are told.
 *
 * @param isNamed whether the address names the files of a scene.
 */
export function followLinkedEffects(
  panel: PanelProps,
  query: URLSearchParams,
  isNamed = (sources: readonly SceneSource[]) => canLink(sources) && !isFallback(sources, query),
): void {
  const { store, viewer } = panel;
  const [effects, crop] = [query.get(EFFECTS_FIELD.name), query.get(SCENE_LINK_FIELDS.crop.name)];
  const take = () => {
    const sources = viewer.scenes.drawable?.parts.map(({ source }) => source) ?? [];
    if (!isNamed(sources)) return;
    if (effects !== null)
      saying(panel, () => chooseEffects(panel, completed(EFFECTS_FIELD.decode(effects), panel)));
    if (crop !== null) saying(panel, () => cropTo(panel, SCENE_LINK_FIELDS.crop.decode(crop)));
  };
  if (store.getState().scene) {
    take();
    return;
  }
  const unsubscribe = store.subscribe(({ scene }) => {
    if (scene === null) return;
    unsubscribe();
    // The scene begins without effects, and its first frame comes later than this.
    queueMicrotask(take);
  });
}

function cropTo(panel: PanelProps, crop: Crop): void {
  panel.store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, crop } }));
  drawCrop(panel);
}

/** Fills in an effect's first values where the address tells none. */
function completed(linked: ReturnType<typeof EFFECTS_FIELD.decode>, { viewer }: PanelProps): EffectChoices {
  const place = scenePlaceOf(viewer);
  return Object.fromEntries(
    Object.entries(linked).map(([name, values]) => [
      name,
      { isOn: true, values: { ...firstValues(name, place), ...values } },
    ]),
  );
}

function saying({ store }: PanelProps, work: () => void): void {
  try {
    work();
  } catch (error) {
    // The engine refuses numbers that an effect cannot have.
    if (!(error instanceof InvalidArgumentError)) throw error;
    const { message } = error;
    store.setState(({ notice }) => ({ notice: notice === null ? message : `${notice} ${message}` }));
  }
}
