import { fileURLToPath } from 'node:url';
import { defaultClientConditions, defineConfig } from 'vite';

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  resolve: { conditions: ['@websplatter/source', ...defaultClientConditions] },
  worker: { format: 'es' },
  build: { target: 'es2022', minify: false },
});
