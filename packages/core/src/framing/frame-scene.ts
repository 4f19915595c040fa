import { fetched } from '../data/errors.ts';
import type { CloudInstance } from '../frame/plan/frame-request.ts';
import type { FrameSceneOptions } from './frame-clouds.ts';
import type { SceneFraming } from './scene-framing.ts';

/**
 * Finds a first camera for a scene: where its detail lies, which way is up, whether it is an object
 * or a place, and from where most of the detail is sharp, in the frame and unhidden.
 *
 * It looks at up to 65,536 splats of all clouds, spread evenly, and works in a worker if one can
 * start. Previews are framed by the splats that have arrived, streamed scenes by a coarse
 * level. Edits and morphs count, and the opacities of clouds and instances; effects do not. The same
 * stored splats give the same answer on every machine, bit for bit; but files of 65,536 splats and more
 * are packed by the GPU, and two GPUs may store them a rounding step apart.
 *
 * @returns null if no splat can be seen.
 * @throws InvalidArgumentError naming the invalid argument; DestroyedError if a cloud, its engine or
 *   its device ends first; GpuLimitError if memory is lacking; SplatSourceError for a preview that is
 *   about to be replaced, and for a streamed scene that cannot be read; WebSplatterError
 *   `worker-failed` if the worker dies; the signal's reason.
 * @example
 * const aspect = widthPx / heightPx;
 * const framing = await frameScene([{ cloud }], { aspect });
 * if (framing) {
 *   const camera = perspectiveCamera({ ...framing, aspect });
 *   view.render({ camera, clouds: [{ cloud }], widthPx, heightPx });
 * }
 */
export async function frameScene(
  clouds: readonly CloudInstance[],
  options: FrameSceneOptions = {},
): Promise<SceneFraming | null> {
  // Pages that frame nothing do not load this module.
  const { frameClouds } = await fetched('framing', import('./frame-clouds.ts'));
  return frameClouds(clouds, options);
}
