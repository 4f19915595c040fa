import { type AccuracyRequest, type SourceOptions, WebSplatterError } from '@websplatter/core';
import { findSplatEngine, type SplatData } from '@websplatter/three';
import { useEffect } from 'react';
import { isServer } from './is-server.ts';
import { sharedCache } from './shared-cache.ts';
import { requestFor, type SplatFileSource } from './splat-cache.ts';
import { useCanvasRenderer } from './use-renderer.ts';

/** Options of `useSplats`. */
export interface UseSplatsOptions {
  /**
   * Accuracy that the file is packed for if it has not been read yet. Default: the accuracy of the
   * surrounding Canvas, or `balanced` outside of one. To draw it more exactly later, the file is read
   * a second time.
   */
  readonly accuracy?: AccuracyRequest;
  /** Limits of reading, and options of requests; the first request for a file decides. */
  readonly sourceOptions?: SourceOptions;
  /**
   * Most bytes of GPU memory for a streamed scene. Default: an equal share of the renderer's
   * `streamBudgetBytes`, which is 512 MiB for all scenes. The first request for a file decides.
   * Outside of a Canvas, such a scene is read as a whole.
   */
  readonly budgetBytes?: number;
}

/**
 * Digest that React writes into a page in place of an error on the server. For this value, Next
 * neither fails the build of a static page nor logs an error; it shows the fallback until the browser
 * has loaded the splats.
 */
const DIGEST = 'BAILOUT_TO_CLIENT_SIDE_RENDERING';

/**
 * Returns the splats of a file, for `<Splats src={splats}>` or for their number and bounds.
 * Suspends until they are read, and throws the errors of reading (`SplatFileError`,
 * `SplatSourceError`). All components with the same source share its splats. Without a source,
 * returns null and reads nothing.
 *
 * A component that is unmounted before its first mount is complete leaves its load running, because
 * React does not notify it; `<Splats src="…">` aborts it. On a server, also when a page is prerendered,
 * it throws a WebSplatterError with the code `server`: the nearest Suspense boundary shows its
 * fallback, and the browser reads the file.
 *
 * @throws InvalidArgumentError for an empty URL.
 * @example
 * function Garden() {
 *   const splats = useSplats('/garden.ply');
 *   return <Splats src={splats} />;
 * }
 */
export function useSplats(source: SplatFileSource, options?: UseSplatsOptions): SplatData;
export function useSplats(
  source: SplatFileSource | null | undefined,
  options?: UseSplatsOptions,
): SplatData | null;
export function useSplats(
  source: SplatFileSource | null | undefined,
  options: UseSplatsOptions = {},
): SplatData | null {
  const renderer = useCanvasRenderer();
  // Throws here for a renderer without splats, not in a load that other Canvases share.
  if (renderer) findSplatEngine(renderer);
  const { accuracy, sourceOptions, budgetBytes } = options;
  const request = source == null ? null : requestFor(source, accuracy, renderer, sourceOptions, budgetBytes);
  if (request && !renderer && isServer()) {
    const reason = 'useSplats()';
    const message = `${reason} reads in browsers only: put a <Suspense> around it.`;
    // Next logs the reason if there is no <Suspense>.
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

/** Prefetches a file, and keeps it until `useSplats.clear`. No-op on servers. */
useSplats.preload = (source: SplatFileSource, options: UseSplatsOptions = {}): void => {
  const { accuracy, sourceOptions, budgetBytes } = options;
  if (!isServer()) sharedCache.preload(requestFor(source, accuracy, undefined, sourceOptions, budgetBytes));
};

/** Releases prefetched files, of `source` or all; files in use go with their last user. */
useSplats.clear = (source?: SplatFileSource): void => sharedCache.clear(source);
