// A separate module, because tests under Jest cannot evaluate `import.meta`; they have no workers.

/** Makers of the workers. Each is one expression, the form that bundlers recognise. */
export const WORKERS = {
  ply: () => new Worker(new URL('../formats/ply/ply-worker.ts', import.meta.url), { type: 'module' }),
  scenes: () => new Worker(new URL('../formats/scene-worker.ts', import.meta.url), { type: 'module' }),
  others: () => new Worker(new URL('../formats/formats-worker.ts', import.meta.url), { type: 'module' }),
} as const;
