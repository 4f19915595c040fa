import {
  type Camera,
  type FrameStatistics,
  type SplatCloud,
  SplatEngine,
  type SplatView,
} from '@websplatter/core';
import { createNodeGpu } from '@websplatter/node';
import type { Picture } from './png.ts';
import type { RenderOptions } from './render-options.ts';
import { differingPixels, type Rendered } from './rendered.ts';
import type { SceneSource } from './scene-source.ts';

/** Measurements come a few frames late; after this long none is expected any more. */
const STATISTICS_TIMEOUT_MS = 2000;

/** Renders with the engine, on a GPU or what stands in for one. */
export async function renderOnGpu(
  scenes: readonly SceneSource[],
  models: readonly Float64Array[],
  camera: Camera,
  options: RenderOptions,
): Promise<Rendered> {
  const { gpu, adapter, label, notice } = await createNodeGpu();
  const engine = await SplatEngine.create({ gpu, adapter, accuracy: options.accuracy });
  try {
    const clouds: SplatCloud[] = [];
    for (const scene of scenes) clouds.push(await addScene(engine, scene));
    const view = engine.createView();
    const frames = await renderFrames(view, clouds, models, camera, options);
    return {
      ...frames,
      splatsPerScene: clouds.map(({ count }) => count),
      label,
      notices: [...(notice === null ? [] : [notice]), ...engine.notices],
    };
  } finally {
    engine.destroy();
  }
}

async function addScene(engine: SplatEngine, { name, content }: SceneSource): Promise<SplatCloud> {
  return 'make' in content ? engine.add(content.make(), { name }) : engine.load(content.source, { name });
}

async function renderFrames(
  view: SplatView,
  clouds: readonly SplatCloud[],
  models: readonly Float64Array[],
  camera: Camera,
  { widthPx, heightPx, frames }: RenderOptions,
): Promise<Pick<Rendered, 'picture' | 'visibleSplats' | 'timings' | 'firstDifference'>> {
  const placed = clouds.map((cloud, i) => ({ cloud, modelMatrix: models[i] }));
  // Sees nothing. Drawn between frames, it makes each of them do all its work again at next to no cost of its own.
  const blindCamera: Camera = { ...camera, near: 1e30, far: Number.POSITIVE_INFINITY };
  const statistics: FrameStatistics[] = [];
  view.onStatistics = (each) => statistics.push(each);

  let first: Picture | undefined;
  let picture: Picture | undefined;
  let firstDifference: Rendered['firstDifference'] = null;
  for (let frame = 1; frame <= frames; frame++) {
    if (frame > 1) view.render({ camera: blindCamera, clouds: placed, widthPx, heightPx });
    view.render({ camera, clouds: placed, widthPx, heightPx });
    picture = await view.readPixels();
    first ??= picture;
    const pixels = differingPixels(first.data, picture.data);
    if (pixels > 0) firstDifference ??= { frame, pixels };
  }
  const measured = () => statistics.filter(({ candidateSplats }) => candidateSplats > 0);
  await waitUntil(() => measured().length >= frames, STATISTICS_TIMEOUT_MS);
  return {
    picture: picture!,
    visibleSplats: measured().at(-1)?.visibleSplats ?? 0,
    timings: measured().map(({ timing }) => timing),
    firstDifference,
  };
}

/** Resolves when `isDone` is, or after `timeoutMs`. */
async function waitUntil(isDone: () => boolean, timeoutMs: number): Promise<void> {
  const deadlineMs = performance.now() + timeoutMs;
  while (!isDone() && performance.now() < deadlineMs) await new Promise((resolve) => setTimeout(resolve, 5));
}
