// Apart from what loads, because tests under Jest cannot evaluate `import.meta`, and do not need to: they have no workers.

/** What makes the workers that read. In one piece each, the form that bundlers recognise. */
export const WORKERS = {
  ply: () => new Worker(new URL('../formats/ply/ply-worker.ts', import.meta.url), { type: 'module' }),
  others: () => new Worker(new URL('../formats/formats-worker.ts', import.meta.url), { type: 'module' }),
} as const;
