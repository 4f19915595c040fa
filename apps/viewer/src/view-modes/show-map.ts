import type { FrameRequest, SplatEngine } from '@websplatter/core';
import { drawAtRest } from '../engine/show/draw-at-rest.ts';
import type { Viewer } from '../engine/viewer.ts';
import { sideDrawn } from '../state/accuracy.ts';
import type { LayerImage } from '../state/frames.ts';
import type { ViewerStore } from '../state/store.ts';
import { isMapMode, type MapFigures, type MapModeName } from '../state/view-mode.ts';
import { contributionImage, countFigures, pixelImage, tileImage } from './cost-map.ts';

interface ModeMap extends LayerImage {
  readonly figures: MapFigures;
}

/**
 * Keeps the map of the view mode on `canvas`, over the picture at rest. Its counts stay while the
 * picture moves. Returns a function that stops this.
 *
 * @param makeMap for tests.
 */
export function showMap(
  canvas: HTMLCanvasElement,
  viewer: Pick<Viewer, 'shownFrame'>,
  store: ViewerStore,
  makeMap = countedMap,
): () => void {
  const stop = drawAtRest<ModeMap>(canvas, viewer, store, {
    asked: ({ restedFrames, viewMode }) => (isMapMode(viewMode) ? `${restedFrames} ${viewMode}` : ''),
    async make() {
      const { viewMode } = store.getState();
      const { shownFrame: shown } = viewer;
      return shown && isMapMode(viewMode) ? makeMap(viewMode, shown.engine, shown.frame, store) : null;
    },
    onShow: (map) => map && store.setState({ mapFigures: map.figures }),
    onFail({ message }) {
      const { viewMode: mode, restedFrames } = store.getState();
      if (isMapMode(mode)) store.setState({ mapFigures: { mode, restedFrames, kind: 'failure', message } });
    },
  });
  return () => {
    stop();
    store.setState({ mapFigures: null });
  };
}

async function countedMap(
  mode: MapModeName,
  engine: SplatEngine,
  frame: FrameRequest,
  store: ViewerStore,
): Promise<ModeMap> {
  const state = store.getState();
  const { comparison, rasterizer: report, restedFrames } = state;
  const { accuracy, detail } = comparison?.kind === 'split' ? sideDrawn(comparison.left, state) : state;
  const { countCosts, mapContributions, UNSEEN_PX } = await import('@websplatter/core/inspect');
  const request = { ...frame, accuracy, detail };
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
    return { ...contributionImage(map, frame.background ?? [0, 0, 0]), figures };
  }
  const costs = await countCosts(engine, request);
  const rasterizer = accuracy.rasterizer === 'auto' ? (report?.rasterizer ?? 'tiles') : accuracy.rasterizer;
  // Quads also blend splats behind opaque ones, which tiles skip.
  const perPixel = rasterizer === 'quads' ? costs.fragments : costs.steps;
  const counts = mode === 'tile-cost' ? costs.tileEntries : perPixel;
  const figures = countFigures(counts);
  const image = mode === 'tile-cost' ? tileImage(costs, figures.end) : pixelImage(costs, counts, figures.end);
  const blendedPart = sum(costs.blended) / Math.max(1, sum(costs.steps));
  return { ...image, figures: { mode, restedFrames, kind: 'cost', rasterizer, blendedPart, ...figures } };
}

function sum(counts: Uint32Array): number {
  return counts.reduce((total, count) => total + count, 0);
}
