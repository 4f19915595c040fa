import type { VisibleSplat } from '../cull/cull.reference.ts';
import { rasterizeSplat } from '../quads/quads.reference.ts';

/** The splat that contributes most to a pixel. */
export interface ReferencePick {
  /** Index in the given list. */
  readonly index: number;
  /** Opacity of the splat at the pixel. */
  readonly alpha: number;
  /** Share of the pixel: `alpha` times the transmittance of the splats in front. */
  readonly weight: number;
  /** Opacity of all splats together at the pixel. */
  readonly totalOpacity: number;
  /** How many splats of the list are in front of it. */
  readonly rank: number;
}

/**
 * Reference of pick: blends the splats of `backToFront` over the pixel in column `xPx` and row
 * `yPx`, front to back. The foremost of equal contributions wins. Returns null if no splat is drawn
 * there.
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
  if (heaviest.weight === 0) return null;
  return { ...heaviest, totalOpacity: 1 - transmittance, rank: backToFront.length - 1 - heaviest.index };
}

/** Rasterizes the splat alone into an image of this pixel: its opacity has a single definition. */
export function alphaAtPixel(splat: VisibleSplat, xPx: number, yPx: number, alphaCutoff: number): number {
  const pixel = { widthPx: 1, heightPx: 1, data: new Float64Array(4) };
  const centerPx = [splat.centerPx[0] - xPx, splat.centerPx[1] - yPx] as const;
  rasterizeSplat(pixel, { ...splat, centerPx }, [0, 0, 0], alphaCutoff);
  return pixel.data[3];
}
