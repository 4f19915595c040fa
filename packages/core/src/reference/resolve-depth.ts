import type { SizePx } from '../accuracy/accuracy.ts';
import type { DepthConvention } from '../camera/depth-convention.ts';

/** Depths as another renderer has stored them. */
export interface HostDepths extends SizePx {
  readonly samples: number;
  /** Sample by sample, pixel by pixel, top row first. */
  readonly values: ArrayLike<number>;
}

/** Where the layer that splats are blended in lies in the host's picture. */
export interface LayerPlace extends SizePx {
  /** The layer's top left. */
  readonly originPx: readonly [number, number];
  /** The host's pixels per pixel of the layer. */
  readonly pxPerLayerPx: readonly [number, number];
}

/** Twin of the GPU's resolve-depth: the farthest sample of the host's pixel behind the middle of each of the layer's. */
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
