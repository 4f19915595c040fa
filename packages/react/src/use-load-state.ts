import type { SplatData } from '@websplatter/three';
import { useCallback, useSyncExternalStore } from 'react';
import { sharedCache } from './shared-cache.ts';
import type { LoadState, SplatRequest } from './splat-cache.ts';
import { useLatest } from './use-latest.ts';

export interface UseLoadStateOptions {
  readonly onProgress?: (event: ProgressEvent) => void;
  /** How long the entry is kept after this, asked for at the end; undefined: as long as it is for all. */
  readonly graceMs: () => number | undefined;
}

/**
 * Loads a request, and holds it in the cache for as long as the component is mounted: being hidden by Suspense does not end
 * that, since it is a passive effect. Undefined until the load has begun, and without a request.
 */
export function useLoadState(
  request: SplatRequest | null,
  options: UseLoadStateOptions,
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
