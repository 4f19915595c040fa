import { EFFECT_OPTIONS, type OptionValues } from '@websplatter/core/effect-options';
import { editPicture } from '../engine/edit-picture.ts';
import { scenePlaceOf } from '../engine/show/scene-place.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { chosenUses, firstValues } from '../state/effect-values.ts';
import { type EffectChoices, NO_CHOICES } from '../state/effects.ts';
import { EFFECTS_FIELD } from './effects-link.ts';

/**
 * Draws with the choices from the next frame on. It is no edit, unlike a person's change by the functions below.
 *
 * @throws InvalidArgumentError if a number is invalid for its effect; nothing changes then.
 */
export function chooseEffects({ store, viewer }: PanelProps, choices: EffectChoices): void {
  const uses = chosenUses(choices);
  const text = EFFECTS_FIELD.encode(choices);
  store.setState(({ requested }) => ({ requested: { ...requested, choices, text } }));
  viewer.setEffects('effects', uses);
}

/** Switches an effect on, with the earlier choices for it, or off. */
export function switchEffect(panel: PanelProps, name: string, isOn: boolean): void {
  const chosen = panel.store.getState().requested.choices[name];
  choose(panel, name, isOn, chosen?.values ?? firstValuesIn(panel, name));
}

/** Fog begins with the background's colour: of another one, it would end at the scene's edges. */
function firstValuesIn({ viewer }: PanelProps, name: string): OptionValues {
  const values = firstValues(name, scenePlaceOf(viewer));
  const background = viewer.shownFrame?.frame.background;
  return name === 'fog' && background ? { ...values, color: hexOf(background) } : values;
}

function hexOf(color: readonly number[]): string {
  return `#${color
    .map((channel) =>
      Math.round(255 * channel)
        .toString(16)
        .padStart(2, '0'),
    )
    .join('')}`;
}

/**
 * Changes the choices for an effect; does nothing if there are none.
 *
 * @param gesture successive changes of one gesture, such as a drag, are undone together; null for a
 * change of its own.
 */
export function changeEffect(
  panel: PanelProps,
  name: string,
  change: (values: OptionValues) => OptionValues,
  gesture: unknown = null,
): void {
  const chosen = panel.store.getState().requested.choices[name];
  if (chosen) choose(panel, name, chosen.isOn, change(chosen.values), gesture);
}

/** Resets the effect's options to their defaults; it stays on or off. */
export function resetEffect(panel: PanelProps, name: string): void {
  changeEffect(panel, name, () => firstValuesIn(panel, name));
}

/** Switches all effects off and forgets their choices. */
export function resetEffects(panel: PanelProps): void {
  editPicture(panel, 'reset of all effects', () => chooseEffects(panel, NO_CHOICES));
}

function choose(
  panel: PanelProps,
  name: string,
  isOn: boolean,
  values: OptionValues,
  gesture: unknown = null,
): void {
  const { choices } = panel.store.getState().requested;
  const label = EFFECT_OPTIONS[name].effect.label.toLowerCase();
  editPicture(panel, label, () => chooseEffects(panel, { ...choices, [name]: { isOn, values } }), gesture);
}
