import type { AccuracyRequest } from '@websplatter/core';
import { SplatData } from '@websplatter/three';
import { useCallback, useState, useSyncExternalStore } from 'react';
import { sharedCache } from './shared-cache.ts';
import { type CacheableSource, type LoadState, requestFor, type SplatRequest } from './splat-cache.ts';
import { useLatest } from './use-latest.ts';

export interface UseSourceOptions {
  readonly onProgress?: (event: ProgressEvent) => void;
  /** How long the cache is to keep what was read after this; undefined: as long as it does for all. */
  readonly graceMs: () => number | undefined;
}

/** What a source has become so far. */
export interface SourceState {
  /** Of this source or, until it has been read, of the one before; null before the first. */
  readonly splats: SplatData | null;
  /** Undefined until the load has begun, and where there is none. */
  readonly load: LoadState<SplatData> | undefined;
}

/** Reads `src`, packed for `accuracy` where nobody has asked for it before, and keeps what it was before until then. */
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
  // Held in the cache as well: `src` may change back.
  useLoadState(shown.request, { graceMs: options.graceMs });
  return { splats: loaded ?? shown.splats, load };
}

interface Shown {
  readonly splats: SplatData | null;
  readonly request: SplatRequest | null;
}

const NOTHING: Shown = { splats: null, request: null };

/**
 * Loads a request, and holds it in the cache for as long as the component is mounted: being hidden by Suspense does not end
 * that, since it is a passive effect. Undefined until the load has begun, and without a request.
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
