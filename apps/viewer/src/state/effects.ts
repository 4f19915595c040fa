import type { EffectEntry } from '@websplatter/core';
import type { OptionValues } from '@websplatter/core/effect-options';
import type { EffectUse } from '@websplatter/core/effects';

/** Parts of the viewer that ask for effects of every cloud, each for its own. */
export const EFFECT_OWNERS = ['effects', 'view-mode', 'crop'] as const;
/** Parts that ask for other effects of each cloud: marks and removals of single splats. */
export const CLOUD_EFFECT_OWNERS = ['marked', 'removed'] as const;

/** By `cloudKeys`; none of other clouds. */
export type CloudEffects = ReadonlyMap<string, readonly EffectUse[]>;

/** Choices for each effect, by its name; an effect off keeps them. None before the first. */
export type EffectChoices = Readonly<
  Partial<Record<string, { readonly isOn: boolean; readonly values: OptionValues }>>
>;

export const NO_CHOICES: EffectChoices = {};

/** Effects that the scene is drawn with, by owner, in the order of both lists. */
export interface RequestedEffects
  extends Readonly<Record<(typeof EFFECT_OWNERS)[number], readonly EffectUse[]>>,
    Readonly<Record<(typeof CLOUD_EFFECT_OWNERS)[number], CloudEffects>> {
  /** Settings of the Effects panel: `effects` follows from them. */
  readonly choices: EffectChoices;
  /** The choices as text for the address; null without any. */
  readonly text: string | null;
}

export const NO_EFFECTS: RequestedEffects = {
  effects: [],
  'view-mode': [],
  crop: [],
  marked: new Map(),
  removed: new Map(),
  choices: NO_CHOICES,
  text: null,
};

export type EffectOwner = Exclude<keyof RequestedEffects, 'choices' | 'text'>;

export interface EffectsState {
  /** Effects on and off, and why: of each frame while the list is open, else of the frame at rest. */
  readonly effects: readonly EffectEntry[];
  /** Effects that panels ask for; another scene begins without any. */
  readonly requested: RequestedEffects;
  /** Whether the effect `reveal` lets the scene appear by itself. */
  readonly isRevealPlaying: boolean;
}

export const FIRST_EFFECTS: EffectsState = { effects: [], requested: NO_EFFECTS, isRevealPlaying: false };
