import { fileURLToPath } from 'node:url';
import react from '@vitejs/plugin-react';
import { defaultClientConditions, defineConfig } from 'vite';

const repositoryRoot = fileURLToPath(new URL('../..', import.meta.url));

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  // Works below any path of a web server.
  base: './',
  plugins: [react()],
  // The engine and the scenes run from their sources, so that editing them reloads the page.
  resolve: { conditions: ['@websplatter/source', ...defaultClientConditions] },
  worker: { format: 'es' },
  server: { fs: { allow: [repositoryRoot] } },
  // Found up front: a dependency that turns up late makes the development server reload the page.
  optimizeDeps: {
    include: ['react', 'react-dom/client', 'react/jsx-dev-runtime', 'uplot', 'zustand', 'zustand/vanilla'],
  },
});
