import type { Vec3 } from '../camera/vec3.ts';

/** sRGB, as style sheets write it: `#ffd8a8`. */
export type HexColor = `#${string}`;

/** A volume that cuts the scene off. What belongs to other shapes stays as it was chosen for them. */
export interface ClipChoice {
  readonly shape: 'plane' | 'box' | 'sphere';
  /** Middle of the box or of the sphere, a point of the plane; world units. */
  readonly center: Vec3;
  /** Lengths of the box's edges, world units. */
  readonly size: Vec3;
  /** Of the sphere, world units. */
  readonly radius: number;
  /** Where the plane's inside is: turned around y, 0 along z and 90 along x. */
  readonly turnDegrees: number;
  /** How far that direction points above the level of x and z, −90…90. */
  readonly tiltDegrees: number;
  readonly keep: 'inside' | 'outside';
  /** Over which distance splats fade in, world units. */
  readonly softEdge: number;
}

export interface FogChoice {
  /** What is given: the depths where fog begins and is complete, or its density. */
  readonly kind: 'depths' | 'density';
  readonly color: HexColor;
  /** View depths, world units. */
  readonly near: number;
  readonly far: number;
  /** Per world unit. */
  readonly density: number;
}

export interface TintChoice {
  readonly color: HexColor;
}

export interface BrightnessChoice {
  /** Each stop doubles the light. */
  readonly stops: number;
}

export interface RevealChoice {
  /** The camera, or a point in world units. */
  readonly from: 'camera' | Vec3;
  /** How far the scene is shown, world units; Infinity: all of it. */
  readonly radius: number;
  /** Over which distance splats fade in, world units. */
  readonly softEdge: number;
}

/** Overrules what files say of how they were trained. */
export interface AntialiasChoice {
  readonly isAntialiased: boolean;
}

interface ChoiceOf {
  readonly clip: ClipChoice;
  readonly reveal: RevealChoice;
  readonly antialias: AntialiasChoice;
  readonly brightness: BrightnessChoice;
  readonly tint: TintChoice;
  readonly fog: FogChoice;
}

/** Effects that can be chosen by hand, in the order in which they act. */
export const CHOSEN_EFFECTS = ['clip', 'reveal', 'antialias', 'brightness', 'tint', 'fog'] as const;
export type ChosenEffect = (typeof CHOSEN_EFFECTS)[number];
export type EffectChoice<Name extends ChosenEffect = ChosenEffect> = ChoiceOf[Name];

/** What was chosen for each effect; one that is switched off keeps it. None: nothing was chosen yet. */
export type EffectChoices = {
  readonly [Name in ChosenEffect]?: { readonly isOn: boolean; readonly choice: ChoiceOf[Name] };
};

export const NO_CHOICES: EffectChoices = {};
