import { effectOptions } from '../../../options/effect-options.ts';
import { type DepthOfFieldOptions, depthOfField } from './depth-of-field.ts';

/** The first values: the scene's middle is in focus. */
export const options = effectOptions<DepthOfFieldOptions, DepthOfFieldOptions>(
  depthOfField,
  {
    focusDistance: {
      kind: 'number',
      label: 'Depth in focus',
      unit: 'units',
      range: ({ radius }) => [0.02 * radius, 6 * radius],
      first: ({ viewDepth }) => viewDepth,
    },
    aperture: {
      kind: 'number',
      label: 'Radius of the lens',
      unit: 'units',
      range: ({ radius }) => [0, 0.1 * radius],
      first: ({ radius }) => 0.03 * radius,
    },
  },
  (values) => values,
);
