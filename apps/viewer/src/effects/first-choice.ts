import { clamp } from '../camera/vec3.ts';
import type { ChosenEffect, EffectChoice } from '../state/effect-choices.ts';
import { roundedTo, stepFor } from './nice-steps.ts';
import type { ScenePlace } from './scene-place.ts';

/** What an effect begins with: something that can be seen, at the scene's size. */
export function firstChoice<Name extends ChosenEffect>(name: Name, place: ScenePlace): EffectChoice<Name> {
  const firsts: { readonly [Each in ChosenEffect]: EffectChoice<Each> } = {
    clip: firstClip(place),
    reveal: firstReveal(place),
    antialias: { isAntialiased: true },
    brightness: { stops: 0.5 },
    tint: { color: '#ffd8a8' },
    fog: firstFog(place),
  };
  return firsts[name];
}

/** Cuts the upper half off, or leaves what is well inside. */
function firstClip({ center: [x, y, z], radius }: ScenePlace): EffectChoice<'clip'> {
  const rounded = roundingAt(radius);
  return {
    shape: 'plane',
    center: [rounded(x), rounded(y), rounded(z)],
    size: [rounded(radius), rounded(radius), rounded(radius)],
    radius: rounded(0.6 * radius),
    turnDegrees: 0,
    tiltDegrees: -90,
    keep: 'inside',
    softEdge: 0,
  };
}

function firstReveal({ center: [x, y, z], radius }: ScenePlace): EffectChoice<'reveal'> {
  const rounded = roundingAt(radius);
  return {
    from: [rounded(x), rounded(y), rounded(z)],
    radius: rounded(0.6 * radius),
    softEdge: rounded(0.1 * radius),
  };
}

/** Begins before the scene's middle, and is complete behind it. */
function firstFog({ radius, viewDepth }: ScenePlace): EffectChoice<'fog'> {
  const rounded = roundingAt(radius);
  return {
    kind: 'depths',
    color: '#c8d0dc',
    near: rounded(clamp(viewDepth - radius, 0, viewDepth)),
    far: rounded(viewDepth + 1.5 * radius),
    density: roundedTo(0.6 / viewDepth, stepFor(1 / viewDepth)),
  };
}

/** Figures of a scene of this size, short enough to be read. */
function roundingAt(radius: number): (value: number) => number {
  const step = stepFor(radius);
  return (value) => roundedTo(value, step);
}
