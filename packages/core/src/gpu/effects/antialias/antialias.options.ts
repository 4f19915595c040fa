import { effectOptions } from '../../../options/effect-options.ts';
import { antialias } from './antialias.ts';

export const options = effectOptions<boolean | undefined, { readonly state: 'on' | 'off' }>(
  antialias,
  {
    state: {
      kind: 'choice',
      label: 'Antialiasing, whatever the file says',
      choices: () => ({ on: 'On', off: 'Off' }),
      first: 'on',
      note: 'Overrides what the file says about its training.',
    },
  },
  ({ state }) => state === 'on',
);
