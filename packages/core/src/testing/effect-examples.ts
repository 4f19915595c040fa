import type { EffectUse } from '../effects/effect.ts';
import { CLOUD_EFFECTS } from '../effects/effects.ts';
import { antialias, brightness, clip, fog, highlight, opacity, reveal, tint } from '../effects/index.ts';
import { SplatSelection } from '../splats/splat-selection.ts';

const everyThird = new SplatSelection();
everyThird.add(Array.from({ length: 400 }, (_, i) => 3 * i));

/** A use of every effect in CLOUD_EFFECTS that changes the image of a cloud within ±1 of the origin. */
export const EFFECT_EXAMPLES: readonly EffectUse[] = [
  clip({
    volumes: [
      { shape: 'box', center: [0.1, 0, 0.1], size: [2, 1.5, 2], rotation: [0.1, 0.4, -0.2, 0.9] },
      { shape: 'sphere', center: [0.4, 0.2, 0.5], radius: 0.3, keep: 'outside' },
      { shape: 'plane', point: [-0.5, 0, 0], normal: [2, 0.4, 0] },
    ],
    softEdge: 0.1,
  }),
  reveal({ from: [0.3, 0.1, 0.2], radius: 1, softEdge: 0.4 }),
  opacity(0.6),
  antialias(),
  brightness(1.8),
  tint([1, 0.4, 0.8]),
  highlight({ selection: everyThird, color: [1, 0.6, 0], strength: 0.7 }),
  fog({ color: [0.5, 0.6, 0.8], near: 0.5, far: 3 }),
];

for (const { name } of CLOUD_EFFECTS) {
  if (!EFFECT_EXAMPLES.some(({ effect }) => effect.name === name))
    throw new RangeError(`The effect ${name} has no example: it would go untested.`);
}
