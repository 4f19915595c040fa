import type { AccuracyRequest } from '@websplatter/core';
import { SplatData } from '@websplatter/three';
import { useCallback, useState, useSyncExternalStore } from 'react';
import { sharedCache } from './shared-cache.ts';
import { type CacheableSource, type LoadState, requestFor, type SplatRequest } from './splat-cache.ts';
import { useLatest } from './use-latest.ts';

/** Progress of a source. */
export interface SourceState {
  /** Splats of this source or, until it has been read, of the previous one; null before the first. */
  readonly splats: SplatData | null;
  /** Undefined until the load has begun, and for splats in memory. */
  readonly load: LoadState<SplatData> | undefined;
}

/**
 * Loads `src` for `renderer`, packed for `accuracy` or the renderer's own unless it was requested before, and keeps the previous
 * splats until then.
 */
export function useSource(
  src: CacheableSource | SplatData,
  renderer: object,
  accuracy: AccuracyRequest | null,
  onProgress?: (event: ProgressEvent) => void,
): SourceState {
  const request = src instanceof SplatData ? null : requestFor(src, accuracy, renderer);
  const load = useLoadState(request, onProgress);
  const [shown, setShown] = useState<Shown>(NOTHING);
  const loaded = src instanceof SplatData ? src : load?.status === 'loaded' ? load.data : null;
  if (loaded !== null && loaded !== shown.splats) setShown({ splats: loaded, request });
  // Also hold the file on screen in the cache: `src` may change back.
  useLoadState(shown.request);
  return { splats: loaded ?? shown.splats, load };
}

interface Shown {
  readonly splats: SplatData | null;
  readonly request: SplatRequest | null;
}

const NOTHING: Shown = { splats: null, request: null };

/**
 * Loads a request, and holds it in the cache while the component is mounted. Suspense, which hides the component, does not
 * end that, because this is a passive effect. Returns undefined until the load has begun, and without a request.
 */
function useLoadState(
  request: SplatRequest | null,
  onProgress?: (event: ProgressEvent) => void,
): LoadState<SplatData> | undefined {
  const latest = useLatest(onProgress);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the request.
  const watch = useCallback(
    (onChange: () => void) => {
      if (!request) return () => {};
      return sharedCache.watch(request, { onChange, onProgress: (event) => latest.current?.(event) });
    },
    [request?.key, latest],
  );
  const read = () => (request ? sharedCache.stateOf(request) : undefined);
  return useSyncExternalStore(watch, read, read);
}
