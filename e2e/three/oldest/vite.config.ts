import { fileURLToPath } from 'node:url';
import { mergeConfig } from 'vite';
import newest from '../vite.config.ts';

const three = fileURLToPath(new URL('node_modules/three', import.meta.url));

/** The same page with the oldest supported release of three, in the packages beside another too. */
export default mergeConfig(newest, {
  resolve: {
    alias: [
      { find: /^three$/, replacement: `${three}/build/three.module.js` },
      { find: /^three\/(webgpu|tsl)$/, replacement: `${three}/build/three.$1.js` },
      { find: /^three\/addons\//, replacement: `${three}/examples/jsm/` },
    ],
  },
});
