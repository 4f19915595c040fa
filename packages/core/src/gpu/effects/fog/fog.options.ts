import { effectOptions, type HexColor, rgbOf } from '../../../options/effect-options.ts';
import { type FogOptions, fog } from './fog.ts';

interface FogValues {
  readonly kind: 'depths' | 'density';
  /** View depths, world units. */
  readonly near: number;
  readonly far: number;
  /** Per world unit. */
  readonly density: number;
  readonly color: HexColor;
}

/** The first values: fog begins before the scene's middle, and is complete behind it. */
export const options = effectOptions<FogOptions, FogValues>(
  fog,
  {
    kind: {
      kind: 'choice',
      label: 'Kind of fog',
      choices: () => ({ depths: 'Between depths', density: 'By density' }),
      first: 'depths',
    },
    near: {
      kind: 'number',
      label: 'Begins at depth',
      when: { kind: 'depths' },
      unit: 'units',
      range: ({ radius }) => [0, 6 * radius],
      first: ({ radius, viewDepth }) => Math.max(0, viewDepth - radius),
      // `near` stays below `far`: without a distance between them, fog would be a step.
      below: 'far',
    },
    far: {
      kind: 'number',
      label: 'Complete at depth',
      when: { kind: 'depths' },
      unit: 'units',
      range: ({ radius }) => [0, 6 * radius],
      first: ({ radius, viewDepth }) => viewDepth + 1.5 * radius,
    },
    density: {
      kind: 'number',
      label: 'Density',
      when: { kind: 'density' },
      unit: 'per unit',
      range: ({ radius }) => [0, 2 / radius],
      first: ({ viewDepth }) => 0.6 / viewDepth,
    },
    color: { kind: 'color', label: 'Colour', first: '#c8d0dc' },
  },
  ({ kind, color, near, far, density }) =>
    kind === 'density' ? { color: rgbOf(color), density } : { color: rgbOf(color), near, far },
);
