import { fileURLToPath } from 'node:url';
import react from '@vitejs/plugin-react';
import { defaultClientConditions, defineConfig, type Plugin } from 'vite';
import { slimShaders } from '../../packages/tools/slim-shaders.mjs';
import { definedBuildFacts } from '../../packages/tools/src/build-facts.ts';

const repositoryRoot = fileURLToPath(new URL('../..', import.meta.url));

/** Apart from the page's own scripts, so that those can be counted. */
const WORKERS = 'assets/workers';

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  // Works below any path of a web server.
  base: './',
  // The development server shows shaders as they were written.
  plugins: [react(), { ...slimShaders(), apply: 'build' } satisfies Plugin],
  // The engine and the scenes run from their sources, so that editing them reloads the page.
  resolve: { conditions: ['@websplatter/source', ...defaultClientConditions] },
  define: { ...definedBuildFacts() },
  worker: {
    format: 'es',
    rolldownOptions: {
      output: {
        entryFileNames: `${WORKERS}/[name]-[hash].js`,
        chunkFileNames: `${WORKERS}/[name]-[hash].js`,
      },
    },
  },
  build: {
    rolldownOptions: {
      output: {
        // Pages that share parts of the engine with the viewer would otherwise break what it needs at first into dozens of scripts,
        // which compress worse apart: 189 kB by gzip instead of 171.
        codeSplitting: { groups: [{ name: 'initial', tags: ['$initial'] }] },
      },
    },
  },
  server: { fs: { allow: [repositoryRoot] } },
  // Found up front: a dependency that turns up late makes the development server reload the page.
  optimizeDeps: {
    include: ['react', 'react-dom/client', 'react/jsx-dev-runtime', 'zustand', 'zustand/vanilla'],
  },
});
