import { mergeConfig } from 'vite';
import newest from '../vite.config.ts';

/** The same page with the oldest release of three that is supported. */
export default mergeConfig(newest, {
  resolve: {
    alias: [
      { find: /^three$/, replacement: 'three-oldest' },
      { find: /^three\/(.*)$/, replacement: 'three-oldest/$1' },
    ],
  },
});
