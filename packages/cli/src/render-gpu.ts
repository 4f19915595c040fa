import type { Camera, FrameStatistics, SplatCloud, SplatView } from '@websplatter/core';
import { openGpuSession } from './gpu-session.ts';
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
  const { engine, clouds, notice, checkGpuErrors } = await openGpuSession(scenes, options.accuracy);
  try {
    const view = engine.createView();
    const frames = await renderFrames(view, clouds, models, camera, options);
    checkGpuErrors();
    return {
      ...frames,
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
  clouds: readonly SplatCloud[],
  models: readonly Float64Array[],
  camera: Camera,
  { widthPx, heightPx, frames, timings }: RenderOptions,
): Promise<Pick<Rendered, 'picture' | 'visibleSplats' | 'warmUpFrames' | 'timings' | 'firstDifference'>> {
  const placed = clouds.map((cloud, i) => ({ cloud, modelMatrix: models[i] }));
  const statistics: FrameStatistics[] = [];
  const draw = () => {
    view.render({ camera, clouds: placed, widthPx, heightPx, force: true });
    return view.readPixels();
  };
  // The first picture also pays for compiling shaders on the first use; it is not what is asked for by measuring.
  const warmUpFrames = timings === undefined ? 0 : 1;
  if (warmUpFrames > 0) await draw();
  view.onStatistics = (each) => {
    if (each.frame > warmUpFrames) statistics.push(each);
  };

  let first: Picture | undefined;
  let picture: Picture | undefined;
  let firstDifference: Rendered['firstDifference'] = null;
  for (let frame = 1; frame <= frames; frame++) {
    picture = await draw();
    first ??= picture;
    const pixels = differingPixels(first.data, picture.data);
    if (pixels > 0) firstDifference ??= { frame, pixels };
  }
  await waitUntil(() => statistics.length >= frames, STATISTICS_TIMEOUT_MS);
  return {
    picture: picture!,
    visibleSplats: statistics.at(-1)?.visibleSplats ?? 0,
    warmUpFrames,
    timings: statistics.map(({ timing }) => timing),
    firstDifference,
  };
}

/** Resolves when `isDone` is, or after `timeoutMs`. */
async function waitUntil(isDone: () => boolean, timeoutMs: number): Promise<void> {
  const deadlineMs = performance.now() + timeoutMs;
  while (!isDone() && performance.now() < deadlineMs) await new Promise((resolve) => setTimeout(resolve, 5));
}
