import { type AccuracyRequest, type SourceOptions, WebSplatterError } from '@websplatter/core';
import { findSplatEngine, type SplatData } from '@websplatter/three';
import { useEffect } from 'react';
import { isServer } from './is-server.ts';
import { sharedCache } from './shared-cache.ts';
import { type CacheableSource, requestFor } from './splat-cache.ts';
import { useCanvasRenderer } from './use-renderer.ts';

/** Options of `useSplats`. */
export interface UseSplatsOptions {
  /**
   * Accuracy that the file is packed for if it has not been read yet; default: that of the
   * surrounding Canvas, or `balanced` outside of one. To be drawn more exactly, the file has to be
   * read a second time.
   */
  readonly accuracy?: AccuracyRequest;
  /** Limits of reading, and how an address is fetched; the first request for a file decides. */
  readonly sourceOptions?: SourceOptions;
  /**
   * GPU memory for a scene that streams, at most, default 512 MiB; the first request for a file
   * decides. Outside of a Canvas, such a scene is read as a whole.
   */
  readonly budgetBytes?: number;
}

/**
 * Digest that React puts into a page in place of an error on the server. Next knows this one: it
 * neither ends the build of a static page nor logs anything, but shows the fallback until the
 * browser has the splats.
 */
const DIGEST = 'BAILOUT_TO_CLIENT_SIDE_RENDERING';

/**
 * Returns the splats of a file, for `<Splats src={splats}>` or for their number and bounds.
 * Suspends until they are read, and throws the errors of reading (`SplatFileError`,
 * `SplatSourceError`). All components with the same source share its splats. Without a source,
 * returns null and reads nothing.
 *
 * A component that is unmounted before it has appeared leaves its load running, because React does
 * not notify it; `<Splats src="…">` aborts it. On a server it throws a WebSplatterError with the
 * code `server`, so that the nearest Suspense boundary shows its fallback there, also in a page
 * that is rendered in advance; the browser reads the file.
 *
 * @throws InvalidArgumentError for an empty address.
 */
export function useSplats(source: CacheableSource, options?: UseSplatsOptions): SplatData;
export function useSplats(
  source: CacheableSource | null | undefined,
  options?: UseSplatsOptions,
): SplatData | null;
export function useSplats(
  source: CacheableSource | null | undefined,
  options: UseSplatsOptions = {},
): SplatData | null {
  const renderer = useCanvasRenderer();
  // Fails here where it has to, and not in a load that other Canvases share.
  if (renderer) findSplatEngine(renderer);
  const { accuracy, sourceOptions, budgetBytes } = options;
  const request = source == null ? null : requestFor(source, accuracy, renderer, sourceOptions, budgetBytes);
  if (request && isServer()) {
    const reason = 'useSplats()';
    const message = `${reason} reads in browsers only: put a <Suspense> around it.`;
    // Next writes the reason where there is no <Suspense>.
    throw Object.assign(new WebSplatterError('server', message), { digest: DIGEST, reason });
  }
  const state = request && sharedCache.ask(request);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the request.
  useEffect(() => (request ? sharedCache.watch(request, {}) : undefined), [request?.key]);
  if (!state) return null;
  if (state.status === 'loaded') return state.data;
  // Not `use(state.settled)`: React would then expect `use` again when it renders again, with
  // nothing left to wait for.
  throw state.status === 'failed' ? state.error : state.settled;
}

/** Starts reading a file ahead of use, and keeps it until `useSplats.clear`. No-op on servers. */
useSplats.preload = (source: CacheableSource, options: UseSplatsOptions = {}): void => {
  const { accuracy, sourceOptions, budgetBytes } = options;
  if (!isServer()) sharedCache.preload(requestFor(source, accuracy, undefined, sourceOptions, budgetBytes));
};

/** Releases preloaded files, of `source` or all; those on screen go with their last user. */
useSplats.clear = (source?: CacheableSource): void => sharedCache.clear(source);
