import { fileURLToPath } from 'node:url';
import react from '@vitejs/plugin-react';
import { defaultClientConditions, defineConfig } from 'vite';
import { definedBuildFacts } from '../../packages/tools/src/build-facts.ts';
import { LICENSES_ADDRESS } from '../viewer/src/state/licenses-address.ts';

const repositoryRoot = fileURLToPath(new URL('../..', import.meta.url));

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  // Works below any path of a web server: beside the viewer it is lab/.
  base: './',
  plugins: [react()],
  // The packages run from their sources, so that editing them reloads the page.
  resolve: { conditions: ['@websplatter/source', ...defaultClientConditions] },
  define: { ...definedBuildFacts() },
  worker: { format: 'es' },
  server: { fs: { allow: [repositoryRoot] } },
  // The runner builds peers' pages by itself. Dependencies found late would reload the page.
  optimizeDeps: {
    entries: 'index.html',
    include: ['react', 'react-dom/client', 'react/jsx-dev-runtime'],
  },
  build: { target: 'es2022', license: { fileName: LICENSES_ADDRESS } },
});
