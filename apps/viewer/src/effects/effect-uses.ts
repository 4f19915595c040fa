import {
  antialias,
  brightness,
  type ClipVolume,
  clip,
  type EffectFunction,
  type EffectUse,
  fog,
  reveal,
  tint,
} from '@websplatter/core/effects';
import type { Vec3 } from '../camera/vec3.ts';
import {
  CHOSEN_EFFECTS,
  type ChosenEffect,
  type ClipChoice,
  type EffectChoice,
  type EffectChoices,
  type FogChoice,
  type HexColor,
} from '../state/effect-choices.ts';

/** The engine's effect behind each choice, with its name for people. */
export const EFFECTS: Readonly<Record<ChosenEffect, Pick<EffectFunction<never>, 'effect'>>> = {
  clip,
  reveal,
  antialias,
  brightness,
  tint,
  fog,
};

const USES: { readonly [Name in ChosenEffect]: (choice: EffectChoice<Name>) => EffectUse } = {
  clip: (choice) => clip({ volumes: [clipVolume(choice)], softEdge: choice.softEdge }),
  reveal: (choice) => reveal(choice),
  antialias: ({ isAntialiased }) => antialias(isAntialiased),
  brightness: ({ stops }) => brightness(2 ** stops),
  tint: ({ color }) => tint(rgbOf(color)),
  fog: (choice) => fog(fogOptions(choice)),
};

/** What the engine is to be asked for: the effects that are switched on. */
export function chosenUses(choices: EffectChoices): readonly EffectUse[] {
  return CHOSEN_EFFECTS.flatMap((name) => {
    const chosen = choices[name];
    const use = USES[name] as (choice: EffectChoice) => EffectUse;
    return chosen?.isOn ? [use(chosen.choice)] : [];
  });
}

/** The volume that stays, or that is taken away. */
export function clipVolume(choice: ClipChoice): ClipVolume {
  const { shape, center, size, radius, keep } = choice;
  if (shape === 'box') return { shape, center, size, keep };
  if (shape === 'sphere') return { shape, center, radius, keep };
  return { shape, point: center, normal: planeNormal(choice), keep };
}

/** Points to the inside; length 1. */
export function planeNormal({ turnDegrees, tiltDegrees }: ClipChoice): Vec3 {
  const [turn, tilt] = [radians(turnDegrees), radians(tiltDegrees)];
  return [Math.cos(tilt) * Math.sin(turn), Math.sin(tilt), Math.cos(tilt) * Math.cos(turn)];
}

/** Red, green and blue, 0…1. */
function rgbOf(color: HexColor): Vec3 {
  const byte = (at: number) => Number.parseInt(color.slice(at, at + 2), 16) / 255;
  return [byte(1), byte(3), byte(5)];
}

function fogOptions({ kind, color, near, far, density }: FogChoice) {
  return kind === 'density' ? { color: rgbOf(color), density } : { color: rgbOf(color), near, far };
}

function radians(degrees: number): number {
  return (degrees * Math.PI) / 180;
}
