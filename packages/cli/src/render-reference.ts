import { type Harmonics, type SplatSet, type StageTimings, wallClockTimings } from '@websplatter/core';
import { renderReferenceInTurns } from '@websplatter/core/reference';
import { SplatFramer } from '@websplatter/core/write';
import type { CameraChoice } from './choose-camera.ts';
import { type Console, tenthsOf } from './console.ts';
import type { RenderOptions } from './render-options.ts';
import { differingPixels, type Rendered } from './rendered.ts';
import { readScene, type SceneSource } from './scene-source.ts';

/** From here on, drawing takes seconds, and a line per ten percent of it is written. */
const MANY_SPLATS = 100_000;

/** Renders in float64 on the CPU. */
export async function renderOnReference(
  scenes: readonly SceneSource[],
  models: readonly Float64Array[],
  choice: CameraChoice,
  { time, sortBy, widthPx, heightPx, accuracy, frames }: RenderOptions,
  console: Console,
): Promise<Rendered> {
  const sets: SplatSet<Harmonics>[] = [];
  for (const scene of scenes) sets.push(await readScene(scene, 'f32'));
  const clouds = sets.map((set, i) => ({ set, modelMatrix: models[i], time }));
  const chosen = await choice.choose((wishes) => {
    const framer = new SplatFramer();
    for (const { set, modelMatrix } of clouds) framer.add(set, modelMatrix);
    return framer.frame(wishes);
  });
  const { camera } = chosen;
  const splats = sets.reduce((sum, { count }) => sum + count, 0);
  const showTenths = frames * splats < MANY_SPLATS ? () => {} : tenthsOf(console);
  const draw = (frame: number) =>
    renderReferenceInTurns(
      { clouds, camera, sortBy, widthPx, heightPx, settings: accuracy },
      {
        onProgress: (fraction) =>
          showTenths({ done: frame - 1 + fraction, total: frames, label: 'drawing in float64' }),
      },
    );

  const timings: StageTimings[] = [];
  let first: Awaited<ReturnType<typeof draw>> | undefined;
  let image: Awaited<ReturnType<typeof draw>> | undefined;
  let firstDifference: Rendered['firstDifference'] = null;
  for (let frame = 1; frame <= frames; frame++) {
    const startedMs = performance.now();
    image = await draw(frame);
    timings.push(wallClockTimings(performance.now() - startedMs));
    first ??= image;
    const pixels = differingPixels(first.data, image.data);
    if (pixels > 0) firstDifference ??= { frame, pixels };
  }
  return {
    chosen,
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
