import type { Vec3 } from '../../../data/math/mat4.ts';
import { effectOptions } from '../../../options/effect-options.ts';
import { type RevealOptions, reveal } from './reveal.ts';

interface RevealValues {
  readonly from: 'camera' | Vec3;
  /** Splats farther away are hidden, world units; Infinity: all splats are drawn. */
  readonly radius: number;
  /** Width of the band in which splats fade in, world units. */
  readonly softEdge: number;
}

export const options = effectOptions<RevealOptions, RevealValues>(
  reveal,
  {
    from: { kind: 'origin', label: 'Where it appears from' },
    radius: {
      kind: 'number',
      label: 'Radius',
      unit: 'units',
      // A camera is usually outside of the scene: a radius from there must reach its far side.
      range: ({ radius }, { from }) => [0, (from === 'camera' ? 6 : 2) * radius],
      first: ({ radius }) => 0.6 * radius,
      isEndless: true,
    },
    softEdge: {
      kind: 'number',
      label: 'Soft edge',
      unit: 'units',
      range: ({ radius }) => [0, radius],
      first: ({ radius }) => 0.1 * radius,
    },
  },
  (values) => values,
);
