import {
  type FrameRasterizer,
  type FrameRequest,
  type FrameStatistics,
  frameScene,
  type SplatView,
} from '@websplatter/core';
import type { CameraChoice } from './choose-camera.ts';
import { findDetail } from './detail.ts';
import { openGpuSession } from './gpu-session.ts';
import type { RawImage } from './images.ts';
import type { RenderOptions } from './render-options.ts';
import { differingPixels, type Rendered } from './rendered.ts';
import type { SceneSource } from './scene-source.ts';

/** Measurements arrive a few frames late; after this long no more are expected. */
const STATISTICS_TIMEOUT_MS = 2000;

/** Renders with the engine, on a GPU or a software adapter. */
export async function renderOnGpu(
  scenes: readonly SceneSource[],
  models: readonly Float64Array[],
  choice: CameraChoice,
  options: RenderOptions,
): Promise<Rendered> {
  const { engine, clouds, notice, checkGpuErrors } = await openGpuSession(scenes, options.accuracy);
  try {
    const { time, sortBy, widthPx, heightPx, detail } = options;
    const placed = clouds.map((cloud, i) => ({ cloud, modelMatrix: models[i], time }));
    const chosen = await choice.choose((wishes) => frameScene(placed, wishes));
    const asked = { camera: chosen.camera, clouds: placed, sortBy, widthPx, heightPx, detail };
    const { drawn, measuredPsnrDb } = await findDetail(engine.createView(), asked);
    const frames = await renderFrames(engine.createView(), { ...asked, detail: drawn }, options);
    checkGpuErrors();
    return {
      ...frames,
      chosen,
      psnrDb: measuredPsnrDb,
      splatsPerScene: clouds.map(({ count }) => count),
      label: engine.adapterLabel,
      notices: [...(notice === null ? [] : [notice]), ...engine.notices],
    };
  } finally {
    engine.destroy();
  }
}

async function renderFrames(
  view: SplatView,
  frame: FrameRequest,
  { frames, timings }: RenderOptions,
): Promise<Omit<Rendered, 'chosen' | 'splatsPerScene' | 'label' | 'notices' | 'psnrDb'>> {
  const statistics: FrameStatistics[] = [];
  const draw = () => {
    view.render({ ...frame, force: true });
    return view.readPixels();
  };
  // The first frame also pays for compiling shaders, which is not to be measured.
  const warmUpFrames = timings === undefined ? 0 : 1;
  if (warmUpFrames > 0) await draw();
  view.onStatistics = (each) => {
    if (each.frame > warmUpFrames) statistics.push(each);
  };

  // The choice of a rasteriser may change between two frames; each draws the same image every time.
  const firstBy = new Map<FrameRasterizer | undefined, RawImage>();
  let image: RawImage | undefined;
  let firstDifference: Rendered['firstDifference'] = null;
  for (let number = 1; number <= frames; number++) {
    image = await draw();
    await waitUntil(() => statistics.length >= number, STATISTICS_TIMEOUT_MS);
    const rasterizer = statistics.at(-1)?.rasterizer;
    const first = firstBy.get(rasterizer) ?? image;
    firstBy.set(rasterizer, first);
    const pixels = differingPixels(first.data, image.data);
    if (pixels > 0) firstDifference ??= { frame: number, pixels };
  }
  const drawnBy = (name: FrameRasterizer) =>
    statistics.filter(({ rasterizer }) => rasterizer === name).length;
  const { reason, tilesMs, quadsMs } = view.rasterizer;
  return {
    image: image!,
    visibleSplats: statistics.at(-1)?.visibleSplats ?? 0,
    warmUpFrames,
    timings: statistics.map(({ timing }) => timing),
    rasterizer: { frames: { tiles: drawnBy('tiles'), quads: drawnBy('quads') }, reason, tilesMs, quadsMs },
    firstDifference,
  };
}

/** Resolves once `isDone` returns true, or after `timeoutMs`. */
async function waitUntil(isDone: () => boolean, timeoutMs: number): Promise<void> {
  const deadlineMs = performance.now() + timeoutMs;
  while (!isDone() && performance.now() < deadlineMs) await new Promise((resolve) => setTimeout(resolve, 5));
}
