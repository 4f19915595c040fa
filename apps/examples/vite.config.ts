import { fileURLToPath } from 'node:url';
import react from '@vitejs/plugin-react';
import { defaultClientConditions, defineConfig } from 'vite';
import { sceneFiles } from './scenes/scene-files.ts';

const repositoryRoot = fileURLToPath(new URL('../..', import.meta.url));

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  // Works below any path of a web server.
  base: './',
  plugins: [react(), sceneFiles()],
  // The packages run from their sources, so that editing them reloads the page.
  resolve: { conditions: ['@websplatter/source', ...defaultClientConditions] },
  worker: { format: 'es' },
  server: { fs: { allow: [repositoryRoot] } },
  build: { target: 'es2022', chunkSizeWarningLimit: 2000 },
});
