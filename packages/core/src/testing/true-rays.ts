import type { RayOptions } from '../clouds/rays/ray-tree.ts';
import { DILATION_PX2, resolveAccuracy } from '../data/accuracy/accuracy.ts';
import { type Camera, pixelRay, projectionOf } from '../data/camera/camera.ts';
import { cloudView } from '../data/camera/cloud-view.ts';
import { identity4, type Vec3 } from '../data/math/mat4.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { type CulledSplat, cullSplat } from '../stages/cull/cull.reference.ts';
import { pickSplat } from '../stages/pick/pick.reference.ts';

/** A ray through the middle of a pixel, and that pixel's depth and cover. */
export interface TrueRay {
  readonly origin: Vec3;
  /** Scaled to a view depth of 1, so that distances along it are view depths. */
  readonly direction: Vec3;
  /** Opacity of all splats at the pixel. */
  readonly opacity: number;
  /** View depth of the splat that contributes most; Infinity if there is none. */
  readonly depthView: number;
  /** Options with which a RayTree hits the splats that are drawn at the pixel. */
  readonly options: RayOptions;
}

/** Returns the rays through `pixels`, with depth and opacity by the float64 reference. */
export function trueRays(
  set: SplatSet<Harmonics>,
  camera: Camera,
  widthPx: number,
  heightPx: number,
  pixels: readonly (readonly [xPx: number, yPx: number])[],
): TrueRay[] {
  const { alphaCutoff } = resolveAccuracy('reference');
  const projection = projectionOf(camera, widthPx, heightPx);
  const view = cloudView(camera.viewMatrix, identity4(), set.origin, projection.isOrthographic);
  const visible: CulledSplat[] = [];
  for (let index = 0; index < set.count; index++) {
    const splat = cullSplat(set, index, view, projection, { alphaCutoff, dilationPx2: DILATION_PX2 });
    if (splat) visible.push(splat);
  }
  visible.sort((a, b) => b.depthView - a.depthView);
  const options = { view: { camera, heightPx }, near: camera.near, far: camera.far };
  return pixels.map(([x, y]) => {
    const there = visible.filter(
      ({ centerPx, extentPx }) =>
        Math.abs(centerPx[0] - x - 0.5) <= extentPx[0] && Math.abs(centerPx[1] - y - 0.5) <= extentPx[1],
    );
    const picked = pickSplat(there, x, y, alphaCutoff);
    const ray = pixelRay(camera, projection, [x + 0.5, y + 0.5]);
    return {
      ...ray,
      options,
      opacity: picked?.totalOpacity ?? 0,
      depthView: picked ? there[picked.index].depthView : Number.POSITIVE_INFINITY,
    };
  });
}
