import type { Vec3 } from '../../../data/math/mat4.ts';
import { effectOptions, type HexColor, rgbOf } from '../../../options/effect-options.ts';
import { tint } from './tint.ts';

export const options = effectOptions<Vec3, { readonly color: HexColor }>(
  tint,
  { color: { kind: 'color', label: 'Colour', first: '#ffd8a8' } },
  ({ color }) => rgbOf(color),
);
