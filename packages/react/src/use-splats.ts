import type { AccuracyRequest } from '@websplatter/core';
import { type SplatData, splatEngineOf } from '@websplatter/three';
import { useEffect } from 'react';
import { isServer } from './is-server.ts';
import { sharedCache } from './shared-cache.ts';
import { type CacheableSource, requestFor } from './splat-cache.ts';
import { useCanvasRenderer } from './use-renderer.ts';

export interface UseSplatsOptions {
  /**
   * For what the file is packed where it has not been read yet; by default as the Canvas around draws, `balanced` outside of
   * one. To be drawn more exactly, it has to be read a second time.
   */
  readonly accuracy?: AccuracyRequest;
}

/**
 * The splats of a file, for `<Splats src={splats}>` and for whoever wants their number or bounds. Suspends until they are
 * read and throws what reading throws (`SplatFileError`, `SplatSourceError`). All who name one source share it.
 *
 * A component that is unmounted before it has ever appeared leaves its load running, since React does not tell;
 * `<Splats src="…">` aborts it. On a server it throws, so that the nearest Suspense boundary shows its fallback there.
 */
export function useSplats(source: CacheableSource, options: UseSplatsOptions = {}): SplatData {
  const renderer = useCanvasRenderer();
  const accuracy = options.accuracy ?? (renderer ? splatEngineOf(renderer).accuracy : undefined);
  const request = requestFor(source, accuracy);
  if (isServer())
    throw new Error(`useSplats(${source}) can only read in a browser: put a <Suspense> around it.`);
  const state = sharedCache.ask(request);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the request.
  useEffect(() => {
    const stop = sharedCache.watch(request, {});
    return () => stop();
  }, [request.key]);
  if (state.status === 'loaded') return state.data;
  // Not `use(state.settled)`: React then wants `use` again when the render goes on, with nothing to wait for any more.
  throw state.status === 'failed' ? state.error : state.settled;
}

/** Starts to read a file ahead of its use, and keeps it until `useSplats.clear`. Does nothing on a server. */
useSplats.preload = (source: CacheableSource, { accuracy }: UseSplatsOptions = {}): void => {
  if (!isServer()) sharedCache.preload(requestFor(source, accuracy));
};

/** Lets go of what was preloaded, of `source` or of all; what is on the screen goes with its last user. */
useSplats.clear = (source?: CacheableSource): void => sharedCache.clear(source);
