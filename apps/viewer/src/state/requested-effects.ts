import type { EffectUse } from '@websplatter/core/effects';

/** Parts of the viewer that ask for effects, each for its own. */
export const EFFECT_OWNERS = ['effects', 'inspecting', 'view-mode', 'crop'] as const;
export type EffectOwner = (typeof EFFECT_OWNERS)[number];

/** Effects that every cloud of the scene is drawn with, by who asks for them, in the order of `EFFECT_OWNERS`. */
export type RequestedEffects = Readonly<Record<EffectOwner, readonly EffectUse[]>>;

export const NO_EFFECTS: RequestedEffects = { effects: [], inspecting: [], 'view-mode': [], crop: [] };
