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
  const elsewhere = besideThePicture(camera);
  const statistics: FrameStatistics[] = [];
  view.onStatistics = (each) => statistics.push(each);
  let drawn = 0;
  const asked = new Set<number>();

  let first: Picture | undefined;
  let picture: Picture | undefined;
  let firstDifference: Rendered['firstDifference'] = null;
  for (let frame = 1; frame <= frames; frame++) {
    if (frame > 1 && view.render({ camera: elsewhere, clouds: placed, widthPx, heightPx })) drawn++;
    if (view.render({ camera, clouds: placed, widthPx, heightPx })) asked.add(++drawn);
    picture = await view.readPixels();
    first ??= picture;
    const pixels = differingPixels(first.data, picture.data);
    if (pixels > 0) firstDifference ??= { frame, pixels };
  }
  const measured = () => statistics.filter(({ frame }) => asked.has(frame));
  await waitUntil(() => measured().length >= asked.size, STATISTICS_TIMEOUT_MS);
  return {
    picture: picture!,
    visibleSplats: measured().at(-1)?.visibleSplats ?? 0,
    timings: measured().map(({ timing }) => timing),
    firstDifference,
  };
}

/**
 * The same camera with its picture moved far to the side, where it sees nothing. Drawn between two frames, it makes the
 * second do all its work again, at next to no cost of its own: depths, and with them all buffers, stay as they are.
 */
function besideThePicture(camera: Camera): Camera {
  const projectionMatrix = Float64Array.from(camera.projectionMatrix);
  const isOrthographic = projectionMatrix[11] === 0;
  projectionMatrix[isOrthographic ? 12 : 8] += 1e6;
  return { ...camera, projectionMatrix };
}

/** Resolves when `isDone` is, or after `timeoutMs`. */
async function waitUntil(isDone: () => boolean, timeoutMs: number): Promise<void> {
  const deadlineMs = performance.now() + timeoutMs;
  while (!isDone() && performance.now() < deadlineMs) await new Promise((resolve) => setTimeout(resolve, 5));
}
