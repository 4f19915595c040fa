import type { SizePx } from '../data/accuracy/accuracy.ts';
import type { DepthConvention } from '../data/camera/depth-convention.ts';

/** Depths as the host stores them. */
export interface HostDepths extends SizePx {
  readonly samples: number;
  /** Depth of each sample of each pixel, top row first. */
  readonly values: ArrayLike<number>;
}

/** Place of the layer, which splats are blended in, in the host's image. */
export interface LayerPlace extends SizePx {
  /** Top left of the layer. */
  readonly originPx: readonly [number, number];
  /** Host pixels per pixel of the layer. */
  readonly pxPerLayerPx: readonly [number, number];
}

/** Reference of resolve-depth: per layer pixel, the farthest sample of the host's at its middle. */
export function resolveDepth(
  host: HostDepths,
  { widthPx, heightPx, originPx, pxPerLayerPx }: LayerPlace,
  compare: DepthConvention['compare'],
): Float64Array {
  const farthest = compare === 'less-equal' ? Math.max : Math.min;
  return Float64Array.from({ length: widthPx * heightPx }, (_, i) => {
    const x = originPx[0] + Math.floor(((i % widthPx) + 0.5) * pxPerLayerPx[0]);
    const y = originPx[1] + Math.floor((Math.floor(i / widthPx) + 0.5) * pxPerLayerPx[1]);
    const first = host.samples * (y * host.widthPx + x);
    return farthest(...Array.from({ length: host.samples }, (__, sample) => host.values[first + sample]));
  });
}
