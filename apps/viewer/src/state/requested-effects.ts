import type { EffectUse } from '@websplatter/core/effects';
import { type EffectChoices, NO_CHOICES } from './effect-choices.ts';

/** Parts of the viewer that ask for effects, each for its own. */
export const EFFECT_OWNERS = ['effects', 'inspecting', 'view-mode', 'crop'] as const;
export type EffectOwner = (typeof EFFECT_OWNERS)[number];

/** Effects that every cloud of the scene is drawn with, by who asks for them, in the order of `EFFECT_OWNERS`. */
export interface RequestedEffects extends Readonly<Record<EffectOwner, readonly EffectUse[]>> {
  /** What the Effects panel was set to: `effects` follows from it. */
  readonly choices: EffectChoices;
}

export const NO_EFFECTS: RequestedEffects = {
  effects: [],
  inspecting: [],
  'view-mode': [],
  crop: [],
  choices: NO_CHOICES,
};
