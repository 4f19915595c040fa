import { fileURLToPath } from 'node:url';
import { build } from 'vite';

const benchFolder = fileURLToPath(new URL('../..', import.meta.url));

/** Builds the page of one adapter into `outDir`, as it would be shipped. Pages share nothing, so that none carries another's code. */
export async function buildPage(adapterPath: string, outDir: string): Promise<void> {
  await build({
    configFile: false,
    root: benchFolder,
    base: './',
    logLevel: 'error',
    resolve: { alias: { 'virtual:bench-adapter': adapterPath } },
    worker: { format: 'es' },
    build: { target: 'es2022', outDir, emptyOutDir: true, chunkSizeWarningLimit: 10_000 },
  });
}
