import { SplatData } from '@websplatter/three';
import { useCallback, useState, useSyncExternalStore } from 'react';
import { sharedCache } from './shared-cache.ts';
import { type LoadState, requestFor, type SplatFileSource, type SplatRequest } from './splat-cache.ts';
import { useLatest } from './stable-values.ts';

/** State of a source. */
export interface SourceState {
  /** Splats to show; null if there are none yet. */
  readonly splats: SplatData | null;
  /** Undefined until the load has begun. */
  readonly load: LoadState<SplatData> | undefined;
}

type Source = SplatFileSource | SplatData | null;

type SourceLoadOptions = Pick<SplatRequest, 'accuracy' | 'sourceOptions' | 'budgetBytes'>;

/**
 * Loads `src`, if there is one, for `renderer`. `options` count for the first request of a file.
 * Returns the previous splats until the load is done; previews if there are none.
 */
export function useSource(
  src: Source,
  renderer: object,
  options: SourceLoadOptions,
  onProgress?: (event: ProgressEvent) => void,
): SourceState {
  const load = useLoadState(src, renderer, options, onProgress);
  const [shown, setShown] = useState(src);
  // Also holds the file on screen in the cache: `src` may change back.
  const onScreen = useLoadState(shown, renderer, options);
  const takesOver = !src || load?.status === 'loaded' || onScreen?.status !== 'loaded';
  if (shown !== src && takesOver) setShown(src);
  // A preview exists on one renderer only.
  const isHere =
    onScreen?.status === 'loaded' || (onScreen?.status === 'pending' && onScreen.renderer === renderer);
  return { splats: isHere ? onScreen.data : null, load };
}

/**
 * Loads a source, and keeps it in the cache while the component is mounted, also while Suspense hides
 * the component: passive effects stay. Returns undefined until the load has begun.
 */
function useLoadState(
  src: Source,
  renderer: object,
  options: SourceLoadOptions,
  onProgress?: (event: ProgressEvent) => void,
): LoadState<SplatData> | undefined {
  const latest = useLatest(onProgress);
  const { accuracy, sourceOptions, budgetBytes } = options;
  const request =
    !src || src instanceof SplatData ? null : requestFor(src, accuracy, renderer, sourceOptions, budgetBytes);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the request.
  const watch = useCallback(
    (onChange: () => void) => {
      if (!request) return () => {};
      return sharedCache.watch(request, { onChange, onProgress: (event) => latest.current?.(event) });
    },
    [request?.key, latest],
  );
  const read = () => (request ? sharedCache.stateOf(request) : undefined);
  const state = useSyncExternalStore(watch, read, read);
  return src instanceof SplatData ? { status: 'loaded', data: src } : state;
}
