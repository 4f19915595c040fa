// A module of its own, because tests under Jest cannot evaluate `import.meta`.

export const makeKeepWorker = () =>
  new Worker(new URL('./keep-worker.ts', import.meta.url), { type: 'module' });
