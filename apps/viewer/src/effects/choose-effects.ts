import {
  type ChosenEffect,
  type EffectChoice,
  type EffectChoices,
  NO_CHOICES,
} from '../state/effect-choices.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import { chosenUses } from './effect-uses.ts';
import { firstChoice } from './first-choice.ts';
import { scenePlaceOf } from './scene-place.ts';

/**
 * Draws with what was chosen from the next frame on.
 *
 * @throws InvalidArgumentError for numbers that an effect cannot have; then nothing changes.
 */
export function chooseEffects({ store, viewer }: PanelProps, choices: EffectChoices): void {
  const uses = chosenUses(choices);
  store.setState(({ requested }) => ({ requested: { ...requested, choices } }));
  viewer.setEffects('effects', uses);
}

/** Switches an effect on, with what was chosen for it before, or off. */
export function switchEffect(panel: PanelProps, name: ChosenEffect, isOn: boolean): void {
  const chosen = panel.store.getState().requested.choices[name];
  choose(panel, name, isOn, chosen?.choice ?? firstChoice(name, scenePlaceOf(panel.viewer)));
}

/** Changes what was chosen for an effect; does nothing before there is anything. */
export function changeEffect<Name extends ChosenEffect>(
  panel: PanelProps,
  name: Name,
  change: (choice: EffectChoice<Name>) => EffectChoice<Name>,
): void {
  const chosen = panel.store.getState().requested.choices[name];
  if (chosen) choose(panel, name, chosen.isOn, change(chosen.choice as EffectChoice<Name>));
}

/** Back to what the effect began with; it stays on or off. */
export function resetEffect(panel: PanelProps, name: ChosenEffect): void {
  changeEffect(panel, name, () => firstChoice(name, scenePlaceOf(panel.viewer)));
}

/** Switches all effects off and forgets what was chosen for them. */
export function resetEffects(panel: PanelProps): void {
  chooseEffects(panel, NO_CHOICES);
}

function choose(panel: PanelProps, name: ChosenEffect, isOn: boolean, choice: EffectChoice): void {
  const { choices } = panel.store.getState().requested;
  chooseEffects(panel, { ...choices, [name]: { isOn, choice } });
}
