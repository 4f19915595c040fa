import { findSplatEngine, type SplatData } from '@websplatter/three';
import { useEffect, useState } from 'react';
import { isServer } from './is-server.ts';
import { sharedCache } from './shared-cache.ts';
import { requestFor, type SplatFileSource } from './splat-cache.ts';
import { useCanvasRenderer } from './use-renderer.ts';
import type { UseSplatsOptions } from './use-splats.ts';

/** Progress and result of reading a file. */
export interface SplatsLoad {
  /** `none` without a source, and on a server. */
  readonly status: 'none' | 'pending' | 'loaded' | 'failed';
  /** Null until the whole file has been read. */
  readonly splats: SplatData | null;
  /** The error that `useSplats` would throw; undefined unless the load has failed. */
  readonly error: unknown;
  /** Bytes read so far. */
  readonly loadedBytes: number;
  /** Size of the file; null if unknown, as for compressed responses: show an indeterminate bar. */
  readonly totalBytes: number | null;
}

const NO_LOAD: SplatsLoad = {
  status: 'none',
  splats: null,
  error: undefined,
  loadedBytes: 0,
  totalBytes: null,
};

/**
 * Reads a file as `useSplats` does, but neither suspends nor throws its errors. Returns progress and
 * result, for a progress bar of your own and `<Splats src={load.splats}>`. Renders on progress. The
 * load is aborted half a second after its last user is unmounted.
 *
 * @param source the file; another one starts another load. Null, undefined or `''`: no load.
 * @throws SplatsUnsupportedRendererError in a Canvas whose renderer cannot draw splats.
 * @example
 * function Garden() {
 *   const { status, splats, loadedBytes, totalBytes } = useSplatsLoad('/garden.ply');
 *   if (status !== 'pending') return <Splats src={splats} />;
 *   const part = totalBytes ? loadedBytes / totalBytes : undefined;
 *   return <Html center><progress value={part} /></Html>;
 * }
 */
export function useSplatsLoad(
  source: SplatFileSource | null | undefined,
  { accuracy, sourceOptions, budgetBytes }: UseSplatsOptions = {},
): SplatsLoad {
  const renderer = useCanvasRenderer();
  // Throws here for a renderer without splats, not in a load that other Canvases share.
  if (renderer) findSplatEngine(renderer);
  const request =
    source && (renderer || !isServer())
      ? requestFor(source, accuracy, renderer, sourceOptions, budgetBytes)
      : null;
  const [known, setKnown] = useState<{ readonly key: string; readonly load: SplatsLoad } | null>(null);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the key stands for the request.
  useEffect(() => {
    if (!request) return;
    const { key } = request;
    let load: SplatsLoad = { ...NO_LOAD, status: 'pending' };
    const take = (change: Partial<SplatsLoad>) => {
      load = { ...load, ...change };
      setKnown({ key, load });
    };
    const takeState = () => {
      const state = sharedCache.stateOf(request);
      if (state?.status === 'loaded') take({ status: 'loaded', splats: state.data });
      if (state?.status === 'failed') take({ status: 'failed', error: state.error });
    };
    const stop = sharedCache.watch(request, {
      onChange: takeState,
      onProgress: ({ loaded, total, lengthComputable }) =>
        take({ loadedBytes: loaded, totalBytes: lengthComputable ? total : null }),
    });
    takeState();
    return stop;
  }, [request?.key]);
  if (!request) return NO_LOAD;
  return known?.key === request.key ? known.load : { ...NO_LOAD, status: 'pending' };
}
