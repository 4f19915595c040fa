import { type SplatData, SplatLoader } from '@websplatter/three';
import { SplatCache } from './splat-cache.ts';

/** The cache of `<Splats>` and `useSplats` in all Canvases. Each load has its own loader, so that it can be aborted alone. */
export const sharedCache = new SplatCache<SplatData>(async ({ source, accuracy }, { signal, onProgress }) => {
  const loader = new SplatLoader().setAccuracy(accuracy);
  signal.addEventListener('abort', () => loader.abort(), { once: true });
  return loader.loadAsync(source, onProgress);
});
