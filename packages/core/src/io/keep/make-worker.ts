// Apart from `keepBricks`, because tests under Jest cannot evaluate `import.meta`.

export const makeKeepWorker = () =>
  new Worker(new URL('./keep-worker.ts', import.meta.url), { type: 'module' });
