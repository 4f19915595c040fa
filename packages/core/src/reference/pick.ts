import type { VisibleSplat } from './cull-splats.ts';
import { rasterizeSplat } from './rasterize.ts';

/** The splat that contributes most to a pixel. */
export interface ReferencePick {
  /** In the list given. */
  readonly index: number;
  /** Its opacity at the pixel. */
  readonly alpha: number;
  /** Its share of the pixel: `alpha` times what those in front let through. */
  readonly weight: number;
  /** Opacity of all splats together at the pixel. */
  readonly totalOpacity: number;
}

/**
 * Twin of the GPU's pick: blends front to back what `backToFront` has over the pixel in column `xPx` and row `yPx`. Of
 * equal contributions the foremost one is taken; null where nothing is drawn.
 */
export function pickSplat(
  backToFront: readonly VisibleSplat[],
  xPx: number,
  yPx: number,
  alphaCutoff: number,
): ReferencePick | null {
  let transmittance = 1;
  let heaviest = { index: -1, alpha: 0, weight: 0 };
  for (let index = backToFront.length - 1; index >= 0; index--) {
    const alpha = alphaAtPixel(backToFront[index], xPx, yPx, alphaCutoff);
    const weight = alpha * transmittance;
    if (weight > heaviest.weight) heaviest = { index, alpha, weight };
    transmittance *= 1 - alpha;
  }
  return heaviest.weight > 0 ? { ...heaviest, totalOpacity: 1 - transmittance } : null;
}

/** By rasterizing the splat alone into a picture of this one pixel: there is one definition of its opacity. */
function alphaAtPixel(splat: VisibleSplat, xPx: number, yPx: number, alphaCutoff: number): number {
  const pixel = { widthPx: 1, heightPx: 1, data: new Float64Array(4) };
  const centerPx = [splat.centerPx[0] - xPx, splat.centerPx[1] - yPx] as const;
  rasterizeSplat(pixel, { ...splat, centerPx }, [0, 0, 0], alphaCutoff);
  return pixel.data[3];
}
