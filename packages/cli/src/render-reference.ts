import {
  type Camera,
  type Harmonics,
  type SplatSet,
  type StageTimings,
  wallClockTimings,
} from '@websplatter/core';
import { renderReference } from '@websplatter/core/reference';
import type { RenderOptions } from './render-options.ts';
import { differingPixels, type Rendered } from './rendered.ts';
import { readScene, type SceneSource } from './scene-source.ts';

/** Renders in float64 on the CPU. */
export async function renderOnReference(
  scenes: readonly SceneSource[],
  models: readonly Float64Array[],
  camera: Camera,
  { sortBy, widthPx, heightPx, accuracy, frames }: RenderOptions,
): Promise<Rendered> {
  const sets: SplatSet<Harmonics>[] = [];
  for (const scene of scenes) sets.push(await readScene(scene, 'f32'));
  const clouds = sets.map((set, i) => ({ set, modelMatrix: models[i] }));
  const draw = () => renderReference({ clouds, camera, sortBy, widthPx, heightPx, settings: accuracy });

  const timings: StageTimings[] = [];
  let first: ReturnType<typeof draw> | undefined;
  let image: ReturnType<typeof draw> | undefined;
  let firstDifference: Rendered['firstDifference'] = null;
  for (let frame = 1; frame <= frames; frame++) {
    const startedMs = performance.now();
    image = draw();
    timings.push(wallClockTimings(performance.now() - startedMs));
    first ??= image;
    const pixels = differingPixels(first.data, image.data);
    if (pixels > 0) firstDifference ??= { frame, pixels };
  }
  return {
    image: image!,
    visibleSplats: image!.visibleSplats,
    psnrDb: null,
    splatsPerScene: sets.map(({ count }) => count),
    warmUpFrames: 0,
    timings,
    rasterizer: null,
    label: 'reference renderer, float64 on the CPU',
    notices: [],
    firstDifference,
  };
}
