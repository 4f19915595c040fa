import { effectOptions } from '../../../options/effect-options.ts';
import { brightness } from './brightness.ts';

export const options = effectOptions<number, { readonly stops: number }>(
  brightness,
  {
    stops: {
      kind: 'number',
      label: 'Exposure',
      unit: 'stops',
      range: () => [-4, 4],
      first: () => 0.5,
    },
  },
  ({ stops }) => 2 ** stops,
);
