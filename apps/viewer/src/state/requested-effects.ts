import type { EffectUse } from '@websplatter/core/effects';
import { type EffectChoices, NO_CHOICES } from './effect-choices.ts';

/** Parts of the viewer that ask for effects of every cloud, each for its own. */
export const EFFECT_OWNERS = ['effects', 'view-mode', 'crop'] as const;
/** Parts that ask for other effects of each cloud: marks of single splats, and what hides them. */
export const CLOUD_EFFECT_OWNERS = ['marked', 'removed'] as const;

/** By `cloudKeys`; none of other clouds. */
export type CloudEffects = ReadonlyMap<string, readonly EffectUse[]>;

/** Effects that the scene is drawn with, by who asks for them, in the order of both lists. */
export interface RequestedEffects
  extends Readonly<Record<(typeof EFFECT_OWNERS)[number], readonly EffectUse[]>>,
    Readonly<Record<(typeof CLOUD_EFFECT_OWNERS)[number], CloudEffects>> {
  /** What the Effects panel was set to: `effects` follows from it. */
  readonly choices: EffectChoices;
}

export const NO_EFFECTS: RequestedEffects = {
  effects: [],
  'view-mode': [],
  crop: [],
  marked: new Map(),
  removed: new Map(),
  choices: NO_CHOICES,
};

export type EffectOwner = Exclude<keyof RequestedEffects, 'choices'>;
