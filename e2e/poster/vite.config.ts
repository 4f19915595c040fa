import { fileURLToPath } from 'node:url';
import react from '@vitejs/plugin-react';
import { defaultClientConditions, defineConfig } from 'vite';

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  plugins: [react()],
  resolve: { conditions: ['@websplatter/source', ...defaultClientConditions] },
  worker: { format: 'es' },
  // React mounts twice under StrictMode in its development build alone.
  define: { 'process.env.NODE_ENV': JSON.stringify('development') },
  build: { target: 'es2022', minify: false },
});
