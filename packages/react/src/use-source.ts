import type { AccuracyRequest } from '@websplatter/core';
import { SplatData } from '@websplatter/three';
import { useCallback, useState, useSyncExternalStore } from 'react';
import { sharedCache } from './shared-cache.ts';
import { type CacheableSource, type LoadState, requestFor, type SplatRequest } from './splat-cache.ts';
import { useLatest } from './use-latest.ts';

export interface UseSourceOptions {
  readonly onProgress?: (event: ProgressEvent) => void;
  /** Returns the time for which the cache keeps the file after its last use; undefined: its default. */
  readonly graceMs: () => number | undefined;
}

/** Progress of a source. */
export interface SourceState {
  /** Splats of this source or, until it has been read, of the previous one; null before the first. */
  readonly splats: SplatData | null;
  /** Undefined until the load has begun, and for splats in memory. */
  readonly load: LoadState<SplatData> | undefined;
}

/** Reads `src`, packed for `accuracy` unless it was requested before, and keeps the previous splats until then. */
export function useSource(
  src: CacheableSource | SplatData,
  accuracy: AccuracyRequest,
  options: UseSourceOptions,
): SourceState {
  const request = src instanceof SplatData ? null : requestFor(src, accuracy);
  const load = useLoadState(request, options);
  const [shown, setShown] = useState<Shown>(NOTHING);
  const loaded = src instanceof SplatData ? src : load?.status === 'loaded' ? load.data : null;
  if (loaded !== null && loaded !== shown.splats) setShown({ splats: loaded, request });
  // Also hold the file on screen in the cache: `src` may change back.
  useLoadState(shown.request, { graceMs: options.graceMs });
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
  options: UseSourceOptions,
): LoadState<SplatData> | undefined {
  const latest = useLatest(options);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the request.
  const watch = useCallback(
    (onChange: () => void) => {
      if (!request) return () => {};
      const onProgress = (event: ProgressEvent) => latest.current.onProgress?.(event);
      const stop = sharedCache.watch(request, { onChange, onProgress });
      return () => stop(latest.current.graceMs());
    },
    [request?.key, latest],
  );
  const read = () => (request ? sharedCache.stateOf(request) : undefined);
  return useSyncExternalStore(watch, read, read);
}
