import { fileURLToPath } from 'node:url';
import { defaultServerConditions, defineConfig } from 'vite';

const conditions = ['@websplatter/source', ...defaultServerConditions];
const path = (name: string) => fileURLToPath(new URL(name, import.meta.url));

/** Bundles scripts for Deno, each with all that it imports. */
export default defineConfig({
  root: path('.'),
  ssr: { noExternal: true, resolve: { conditions } },
  build: {
    ssr: true,
    target: 'es2022',
    minify: false,
    rolldownOptions: {
      input: {
        shaders: path('shaders.ts'),
        together: path('together.ts'),
        'hard-cases': path('hard-cases.ts'),
        // Builds of this kind leave workers out.
        'load-worker': '@websplatter/core/load-worker',
      },
    },
  },
});
