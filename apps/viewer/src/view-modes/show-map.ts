import type { FrameRequest, SplatEngine } from '@websplatter/core';
import { sideAccuracy } from '../state/comparison.ts';
import type { ViewerStore } from '../state/store.ts';
import { isMapMode, type MapModeName } from '../state/view-mode.ts';
import type { MapFigures } from '../state/viewer-state.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { contributionImage, countFigures, type MapImage, pixelImage, tileImage } from './cost-map.ts';

interface ModeMap {
  readonly image: MapImage;
  readonly figures: MapFigures;
}

/**
 * Keeps the map of the view mode on `canvas`, over the picture. The canvas is hidden while the
 * picture moves, and comes back when the frame at rest has been counted; the figures stay until
 * then. Returns a function that stops this.
 *
 * @param makeMap for tests.
 */
export function showMap(
  canvas: HTMLCanvasElement,
  viewer: Pick<Viewer, 'shownFrame'>,
  store: ViewerStore,
  makeMap = countedMap,
): () => void {
  /** Picture at rest and mode that were counted last, or are being counted; those on the canvas. */
  let [counted, drawn] = ['', ''];
  let isBusy = false;
  let isStopped = false;
  const asked = () => {
    const { isIdle, restedFrames, viewMode } = store.getState();
    return isIdle && isMapMode(viewMode) ? `${restedFrames} ${viewMode}` : '';
  };

  const follow = async () => {
    const key = asked();
    canvas.hidden = key === '' || key !== drawn;
    const { viewMode, restedFrames } = store.getState();
    const shown = viewer.shownFrame;
    if (!key || key === counted || isBusy || !shown || !isMapMode(viewMode)) return;
    counted = key;
    isBusy = true;
    const isNeeded = () => !isStopped && asked() === key;
    try {
      const { image, figures } = await makeMap(viewMode, shown.engine, shown.frame, store);
      if (isNeeded()) {
        draw(canvas, image);
        drawn = key;
        store.setState({ mapFigures: figures });
      }
    } catch (error) {
      // A lost device or a replaced scene ends counting too; the viewer reports both itself.
      if (isNeeded() && store.getState().status === 'running') {
        console.error(error);
        const { message } = error as Error;
        store.setState({ mapFigures: { mode: viewMode, restedFrames, kind: 'failure', message } });
      }
    } finally {
      isBusy = false;
      // The same picture may come to rest again.
      if (!isNeeded()) counted = '';
    }
    if (!isStopped && asked() !== counted) void follow();
  };

  canvas.hidden = true;
  void follow();
  const unsubscribe = store.subscribe((state, before) => {
    if (
      state.isIdle !== before.isIdle ||
      state.restedFrames !== before.restedFrames ||
      state.viewMode !== before.viewMode
    )
      void follow();
  });
  return () => {
    isStopped = true;
    unsubscribe();
    store.setState({ mapFigures: null });
  };
}

function draw(canvas: HTMLCanvasElement, { data, widthPx, heightPx }: MapImage): void {
  canvas.width = widthPx;
  canvas.height = heightPx;
  canvas.getContext('2d')?.putImageData(new ImageData(data, widthPx, heightPx), 0, 0);
  canvas.hidden = false;
}

async function countedMap(
  mode: MapModeName,
  engine: SplatEngine,
  frame: FrameRequest,
  store: ViewerStore,
): Promise<ModeMap> {
  const { accuracy: current, comparison, rasterizer: report, restedFrames } = store.getState();
  const accuracy = comparison?.kind === 'split' ? sideAccuracy(comparison.left, current) : current;
  const { countCosts, mapContributions, UNSEEN_PX } = await import('@websplatter/core/inspect');
  const request = { ...frame, accuracy };
  if (mode === 'contribution') {
    const map = await mapContributions(engine, request);
    const { contributionsPx } = map;
    const unseen = contributionsPx.reduce((count, px) => count + Number(px < UNSEEN_PX), 0);
    const figures = {
      mode,
      restedFrames,
      kind: 'contribution',
      splats: contributionsPx.length,
      unseen,
    } as const;
    return { image: contributionImage(map, frame.background ?? [0, 0, 0]), figures };
  }
  const costs = await countCosts(engine, request);
  const rasterizer = accuracy.rasterizer === 'auto' ? (report?.rasterizer ?? 'tiles') : accuracy.rasterizer;
  // Quads blend splats that tiles leave out behind opaque ones.
  const perPixel = rasterizer === 'quads' ? costs.fragments : costs.steps;
  const counts = mode === 'tile-cost' ? costs.tileEntries : perPixel;
  const figures = countFigures(counts);
  const image = mode === 'tile-cost' ? tileImage(costs, figures.end) : pixelImage(costs, counts, figures.end);
  const blendedPart = sum(costs.blended) / Math.max(1, sum(costs.steps));
  return { image, figures: { mode, restedFrames, kind: 'cost', rasterizer, blendedPart, ...figures } };
}

function sum(counts: Uint32Array): number {
  return counts.reduce((total, count) => total + count, 0);
}
