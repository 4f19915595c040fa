import { fileURLToPath } from 'node:url';
import react from '@vitejs/plugin-react';
import { defaultClientConditions, defineConfig } from 'vite';

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  plugins: [react()],
  resolve: {
    conditions: ['@websplatter/source', ...defaultClientConditions],
    // The examples' copy, as tsconfig.json says too.
    alias: {
      '@react-three/drei': fileURLToPath(
        new URL('../../apps/examples/node_modules/@react-three/drei', import.meta.url),
      ),
    },
  },
  worker: { format: 'es' },
  // drei is large.
  build: { target: 'es2022', minify: false, chunkSizeWarningLimit: 10_000 },
});
