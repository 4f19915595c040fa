// Apart from what loads, because tests under Jest cannot evaluate `import.meta`, and do not need to: they have no workers.

/** What makes the worker of each format. In one piece each, the form that bundlers recognise. */
export const WORKERS: Readonly<Record<string, () => Worker>> = {
  ply: () => new Worker(new URL('../formats/ply/ply-worker.ts', import.meta.url), { type: 'module' }),
  spz: () => new Worker(new URL('../formats/spz/spz-worker.ts', import.meta.url), { type: 'module' }),
  gzip: () => new Worker(new URL('../formats/gzip/gzip-worker.ts', import.meta.url), { type: 'module' }),
  gltf: () => new Worker(new URL('../formats/gltf/gltf-worker.ts', import.meta.url), { type: 'module' }),
  sog: () => new Worker(new URL('../formats/sog/sog-worker.ts', import.meta.url), { type: 'module' }),
  zip: () => new Worker(new URL('../formats/zip/zip-worker.ts', import.meta.url), { type: 'module' }),
  'compressed-ply': () =>
    new Worker(new URL('../formats/compressed-ply/compressed-ply-worker.ts', import.meta.url), {
      type: 'module',
    }),
  ksplat: () =>
    new Worker(new URL('../formats/ksplat/ksplat-worker.ts', import.meta.url), { type: 'module' }),
  'ply-points': () =>
    new Worker(new URL('../formats/ply-points/ply-points-worker.ts', import.meta.url), { type: 'module' }),
  splat: () => new Worker(new URL('../formats/splat/splat-worker.ts', import.meta.url), { type: 'module' }),
};
