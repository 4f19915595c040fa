import type { PointCoverage, PointToCover } from '@websplatter/core';
import type { Camera, Object3D, WebGPURenderer } from 'three/webgpu';
import { hitOf, type SplatCloudObject, type SplatHit } from '../cloud/splat-cloud-object.ts';
import { layersAround } from '../layer/splat-layer.ts';

/**
 * Returns the cover of each of at most 1,024 points of the world in the frame that `renderer` drew
 * last from `camera`: how opaque the splats in front of it are together, and whether an opaque mesh
 * that was drawn before the splats is in front of it. One small read-back for all points of clouds
 * with the same `renderOrder`, which no frame waits for.
 *
 * @param scene the scene, or any object in it.
 * @returns null where no splats have been drawn.
 * @throws InvalidArgumentError for too many points and numbers that are not finite; GpuLimitError
 *   if memory is lacking; DestroyedError if the device ends before the result is read.
 * @example
 * const [cover] = (await coverageOf(renderer, scene, camera, [{ point: [0, 1, 0] }])) ?? [];
 * label.hidden = cover !== undefined && cover.opacity > 0.9;
 */
export async function coverageOf(
  renderer: object,
  scene: Object3D,
  camera: Camera,
  points: readonly PointToCover[],
): Promise<PointCoverage[] | null> {
  const views = layersAround(scene).flatMap(({ views }) => views.latest(renderer, camera) ?? []);
  const found = await Promise.all(views.map(({ embedded }) => embedded.coverage(points)));
  const [first, ...others] = found.flatMap((coverage) => (coverage ? [coverage] : []));
  return first ? others.reduce(togetherWith, first) : null;
}

/**
 * Returns the splat, of any cloud in the scene, that contributes most to a pixel of the frame that
 * `renderer` drew last from `camera`; null if there is none, and before the first frame. Clouds
 * with the highest `renderOrder` come first; of these and clouds that fade, the nearest hit.
 *
 * @param scene the scene, or any object in it.
 * @param xPx, yPx physical pixels from the canvas's top left.
 * @throws GpuLimitError if memory is lacking; DestroyedError if the device ends before the result
 *   is read.
 * @example
 * const pick = await pickSplat(renderer, scene, camera, 320, 240);
 * if (pick) console.log(pick.object.name, pick.point);
 */
export async function pickSplat(
  renderer: WebGPURenderer,
  scene: Object3D,
  camera: Camera,
  xPx: number,
  yPx: number,
): Promise<SplatHit | null> {
  const layers = layersAround(scene);
  const hits = await Promise.all(layers.map((layer) => layer.pick(renderer, camera, xPx, yPx)));
  const [first] = hits
    .flatMap((hit, i) => (hit ? [{ hit, order: layers[i].renderOrder }] : []))
    .sort((a, b) => b.order - a.order || a.hit.depthView - b.hit.depthView);
  if (!first) return null;
  const { hit } = first;
  // All clouds of a layer are `SplatCloudObject`s.
  const object = hit.object as unknown as SplatCloudObject;
  return { object, ...hitOf(hit) };
}

/** Returns the cover of points by clouds that are blended one after the other. */
function togetherWith(some: PointCoverage[], others: PointCoverage[]): PointCoverage[] {
  return some.map(({ isInImage, opacity, isBehindHost }, i) => ({
    isInImage,
    opacity: 1 - (1 - opacity) * (1 - others[i].opacity),
    isBehindHost: isBehindHost || others[i].isBehindHost,
  }));
}
