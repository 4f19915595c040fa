import { InvalidArgumentError } from '@websplatter/core';
import { canLink, isFallback } from '../engine/link/page-address.ts';
import type { SceneSource } from '../engine/open/scene-source.ts';
import { scenePlaceOf } from '../engine/show/scene-place.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { drawCrop } from '../inspect/draw-crop.ts';
import { firstValues } from '../state/effect-values.ts';
import type { EffectChoices } from '../state/effects.ts';
import type { Crop } from '../state/inspecting.ts';
import { noticeWith } from '../state/messages.ts';
import { SCENE_LINK_FIELDS } from '../state/scene-link-fields.ts';
import { chooseEffects } from './choose-effects.ts';
import { EFFECTS_FIELD } from './effects-link.ts';

/**
 * Applies the URL's effects and crop to the first scene, if it is the scene that the URL names:
 * lengths would not fit another one. Reports unreadable parts.
 *
 * @param isNamed whether the URL names the scene's files.
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
    if (!isNamed(sources)) {
      say(panel, 'The effects and the crop of the address are left out: they belong to another scene.');
      return;
    }
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
    // The scene is reset to no effects first; its first frame is drawn later.
    queueMicrotask(take);
  });
}

function cropTo(panel: PanelProps, crop: Crop): void {
  panel.store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, crop } }));
  drawCrop(panel);
}

/** Fills in defaults for values that the URL omits. */
function completed(linked: ReturnType<typeof EFFECTS_FIELD.decode>, { viewer }: PanelProps): EffectChoices {
  const place = scenePlaceOf(viewer);
  return Object.fromEntries(
    Object.entries(linked).map(([name, values]) => [
      name,
      { isOn: true, values: { ...firstValues(name, place), ...values } },
    ]),
  );
}

function saying(panel: PanelProps, work: () => void): void {
  try {
    work();
  } catch (error) {
    // The engine throws for numbers that are invalid for an effect.
    if (!(error instanceof InvalidArgumentError)) throw error;
    say(panel, error.message);
  }
}

function say({ store }: PanelProps, text: string): void {
  store.setState(({ notice }) => ({ notice: noticeWith(notice, text) }));
}
