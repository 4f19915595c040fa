import type { OptionValues } from '@websplatter/core/effect-options';
import { encodeEffects } from '../links/effects-text.ts';
import { type EffectChoices, NO_CHOICES } from '../state/requested-effects.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import { chosenUses, firstValues } from './effect-values.ts';
import { scenePlaceOf } from './scene-place.ts';

/**
 * Draws with what was chosen from the next frame on.
 *
 * @throws InvalidArgumentError for numbers that an effect cannot have; then nothing changes.
 */
export function chooseEffects({ store, viewer }: PanelProps, choices: EffectChoices): void {
  const uses = chosenUses(choices);
  const text = encodeEffects(choices);
  store.setState(({ requested }) => ({ requested: { ...requested, choices, text } }));
  viewer.setEffects('effects', uses);
}

/** Switches an effect on, with what was chosen for it before, or off. */
export function switchEffect(panel: PanelProps, name: string, isOn: boolean): void {
  const chosen = panel.store.getState().requested.choices[name];
  choose(panel, name, isOn, chosen?.values ?? firstValues(name, scenePlaceOf(panel.viewer)));
}

/** Changes what was chosen for an effect; does nothing before there is anything. */
export function changeEffect(
  panel: PanelProps,
  name: string,
  change: (values: OptionValues) => OptionValues,
): void {
  const chosen = panel.store.getState().requested.choices[name];
  if (chosen) choose(panel, name, chosen.isOn, change(chosen.values));
}

/** Back to what the effect began with; it stays on or off. */
export function resetEffect(panel: PanelProps, name: string): void {
  changeEffect(panel, name, () => firstValues(name, scenePlaceOf(panel.viewer)));
}

/** Switches all effects off and forgets what was chosen for them. */
export function resetEffects(panel: PanelProps): void {
  chooseEffects(panel, NO_CHOICES);
}

function choose(panel: PanelProps, name: string, isOn: boolean, values: OptionValues): void {
  const { choices } = panel.store.getState().requested;
  chooseEffects(panel, { ...choices, [name]: { isOn, values } });
}
