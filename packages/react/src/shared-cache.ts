import { type SplatData, SplatLoader } from '@websplatter/three';
import { SplatCache } from './splat-cache.ts';

/** What `<Splats>` and `useSplats` of every Canvas share. A loader per load, so that each can be aborted by itself. */
export const sharedCache = new SplatCache<SplatData>(async ({ source, accuracy }, { signal, onProgress }) => {
  const loader = new SplatLoader().setAccuracy(accuracy);
  signal.addEventListener('abort', () => loader.abort(), { once: true });
  return loader.loadAsync(source, onProgress);
});
