import { MAX_FRAGMENT_ALPHA, type SizePx } from '../../data/accuracy/accuracy.ts';
import { stackedAlpha } from '../../reference/stacked-opacity.ts';
import type { VisibleSplat } from '../cull/cull.reference.ts';

/** Premultiplied RGBA in float64, top row first. */
export interface ReferenceImage {
  readonly widthPx: number;
  readonly heightPx: number;
  /** 4·width·height values. */
  readonly data: Float64Array;
}

/** Depths of the host's image, and the target for the splats' own depth. */
export interface ReferenceDepths {
  /** View depth per pixel behind which splats are hidden; Infinity where the host drew nothing. */
  readonly host: ArrayLike<number>;
  /** View depth of the splats, weighted like their colours. */
  readonly splats: Float64Array;
  /** View depth of the splat by which more than half of a pixel is covered; else of the last. */
  readonly medians: Float64Array;
}

/** Reference of rasterize: blends one splat over `image`. Pixel centres are at half-integers. */
export function rasterizeSplat(
  image: ReferenceImage,
  splat: VisibleSplat,
  color: readonly [number, number, number],
  alphaCutoff: number,
  depths?: ReferenceDepths,
): void {
  const { data } = image;
  const { depthView } = splat;
  visitPixels(image, splat, alphaCutoff, (pixel, alpha) => {
    if (depths && depthView > depths.host[pixel]) return;
    const at = 4 * pixel;
    const through = 1 - alpha;
    data[at] = color[0] * alpha + data[at] * through;
    data[at + 1] = color[1] * alpha + data[at + 1] * through;
    data[at + 2] = color[2] * alpha + data[at + 2] * through;
    data[at + 3] = alpha + data[at + 3] * through;
    if (depths) depths.splats[pixel] = depthView * alpha + depths.splats[pixel] * through;
  });
}

/**
 * Reference of tile-rasterize's depth: notes a splat's depth at each pixel of which
 * nearer splats cover less than half.
 *
 * @param transmittances share of the light that passes through all nearer splats, per pixel;
 *   changed for the next one.
 */
export function noteMedianDepth(
  transmittances: Float64Array,
  size: SizePx,
  splat: VisibleSplat,
  alphaCutoff: number,
  { host, medians }: ReferenceDepths,
): void {
  visitPixels(size, splat, alphaCutoff, (pixel, alpha) => {
    if (splat.depthView > host[pixel]) return;
    if (transmittances[pixel] > 0.5) medians[pixel] = splat.depthView;
    transmittances[pixel] *= 1 - alpha;
  });
}

/** Calls `visit` with each pixel where the splat's opacity reaches the cutoff, and that opacity. */
function visitPixels(
  { widthPx, heightPx }: SizePx,
  { centerPx, covariance: { a, b, c, determinant }, opacity, isStacked, extentPx }: VisibleSplat,
  alphaCutoff: number,
  visit: (pixel: number, alpha: number) => void,
): void {
  const left = Math.max(0, Math.ceil(centerPx[0] - extentPx[0] - 0.5));
  const right = Math.min(widthPx - 1, Math.floor(centerPx[0] + extentPx[0] - 0.5));
  const top = Math.max(0, Math.ceil(centerPx[1] - extentPx[1] - 0.5));
  const bottom = Math.min(heightPx - 1, Math.floor(centerPx[1] + extentPx[1] - 0.5));
  for (let row = top; row <= bottom; row++) {
    const y = row + 0.5 - centerPx[1];
    for (let column = left; column <= right; column++) {
      const x = column + 0.5 - centerPx[0];
      const distance2 = (c * x * x - 2 * b * x * y + a * y * y) / determinant;
      const gaussian = Math.exp(-0.5 * distance2);
      const blended = isStacked ? stackedAlpha(opacity, gaussian) : opacity * gaussian;
      const alpha = Math.min(MAX_FRAGMENT_ALPHA, blended);
      if (alpha >= alphaCutoff) visit(row * widthPx + column, alpha);
    }
  }
}
