import { type SplatData, SplatLoader } from '@websplatter/three';
import { SplatCache } from './splat-cache.ts';

/** The cache of `<Splats>` and `useSplats` in all Canvases. Each load has a loader to abort. */
export const sharedCache = new SplatCache<SplatData>(
  async (
    { source, accuracy, renderer, sourceOptions = {}, budgetBytes },
    { signal, onProgress, onPreview },
  ) => {
    const loader = new SplatLoader();
    loader.onPreview = onPreview;
    loader.sourceOptions = sourceOptions;
    loader.budgetBytes = budgetBytes;
    if (accuracy) loader.setAccuracy(accuracy);
    if (renderer) loader.detectSupport(renderer);
    signal.addEventListener('abort', () => loader.abort());
    const data = await loader.loadAsync(source, onProgress);
    data.isCached = true;
    return data;
  },
  (data) => data.dispose(),
);
