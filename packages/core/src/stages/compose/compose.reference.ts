import type { SizePx } from '../../data/accuracy/accuracy.ts';
import type { DepthConvention } from '../../data/camera/depth-convention.ts';
import { decodeSrgb, encodeSrgb } from '../../reference/srgb.ts';

/**
 * Reference of compose: splats over the host's image.
 *
 * @param layer blended splats, premultiplied, sRGB-encoded, 4 values per pixel.
 * @param behind the host's colours, premultiplied, linear, 4 values per pixel.
 * @returns linear, premultiplied, 4 values per pixel; all 0 where there is no splat.
 */
export function compose(layer: ArrayLike<number>, behind: ArrayLike<number>): Float64Array {
  return composePixels(layer, (pixel) => over(valuesAt(layer, pixel), valuesAt(behind, pixel)));
}

/**
 * Reference of a fade: the layer whose composed image is, in sRGB's encoding, the mean of the images
 * with and without its splats, weighted by `fade` and 1 − `fade`. A pixel of transmittance T gets
 * 1 − fade · (1 − T).
 *
 * @param layer blended splats, or their weighted depths.
 * @param fade 0…1.
 */
export function faded(layer: ArrayLike<number>, fade: number): Float64Array {
  return Float64Array.from(layer, (value) => fade * value);
}

/** Least ratio of view depths of two surfaces: EDGE_RATIO of compose.wgsl. */
const EDGE_RATIO = 1.05;

/**
 * Reference of compose for a host's depth with several samples per pixel, which show the edges of
 * meshes. At an edge the host's colour is a mixture. The near surface's part of it, with the splats
 * in front, is taken from the neighbour that shows most of that surface; the rest of the pixel is
 * the far surface under the pixel's own splats.
 *
 * @param depthsView view depths of the host, `samples` per pixel.
 */
export function composeWithEdges(
  layer: ArrayLike<number>,
  behind: ArrayLike<number>,
  depthsView: ArrayLike<number>,
  samples: number,
  size: SizePx,
): Float64Array {
  const samplesOf = (pixel: number) =>
    Array.from({ length: samples }, (_, sample) => depthsView[samples * pixel + sample]);
  return composePixels(layer, (pixel) => {
    const nearest = Math.min(...samplesOf(pixel));
    const [splats, host] = [valuesAt(layer, pixel), valuesAt(behind, pixel)];
    const isNear = (depth: number) => depth <= EDGE_RATIO * nearest;
    const share = samplesOf(pixel).filter(isNear).length / samples;
    if (share === 1) return over(splats, host);
    let [best, bestShare] = [pixel, share];
    for (const neighbor of neighborhood(pixel, size)) {
      const isSameSurface = (depth: number) => isNear(depth) && depth >= nearest / EDGE_RATIO;
      const neighborShare = samplesOf(neighbor).filter(isSameSurface).length / samples;
      if (neighborShare > bestShare) [best, bestShare] = [neighbor, neighborShare];
    }
    const nearHost = valuesAt(behind, best);
    const farHost = host.map((value, i) => Math.max(0, value - share * nearHost[i]) / (1 - share));
    const [far, near] = [over(splats, farHost), over(valuesAt(layer, best), nearHost)];
    return far.map((value, i) => (1 - share) * value + share * near[i]);
  });
}

/**
 * Reference of compose's depth: the mean or median depth of a pixel's splats, as the host stores
 * it.
 *
 * @param depthLayer view depths, blended like a colour, or times the opacity.
 * @param stored maps a view depth at normalised device coordinates (y up) to the host's.
 * @returns −1 where splats cover less than half of the pixel.
 */
export function composeDepth(
  layer: ArrayLike<number>,
  depthLayer: ArrayLike<number>,
  { widthPx, heightPx }: SizePx,
  stored: (depthView: number, ndc: readonly [number, number]) => number,
): Float64Array {
  return Float64Array.from({ length: widthPx * heightPx }, (_, pixel) => {
    const covered = layer[4 * pixel + 3];
    const x = (2 * ((pixel % widthPx) + 0.5)) / widthPx - 1;
    const y = 1 - (2 * (Math.floor(pixel / widthPx) + 0.5)) / heightPx;
    return covered < 0.5 ? -1 : stored(depthLayer[pixel] / covered, [x, y]);
  });
}

function composePixels(layer: ArrayLike<number>, colorAt: (pixel: number) => number[]): Float64Array {
  const image = new Float64Array(layer.length);
  for (let pixel = 0; pixel < layer.length / 4; pixel++)
    if (layer[4 * pixel + 3] > 0) image.set(colorAt(pixel), 4 * pixel);
  return image;
}

function valuesAt(image: ArrayLike<number>, pixel: number): number[] {
  return [0, 1, 2, 3].map((channel) => image[4 * pixel + channel]);
}

/** Composes `splats`, encoded, over `host`, linear; both premultiplied. So is the linear result. */
function over(splats: readonly number[], host: readonly number[]): number[] {
  const [covered, hostOpacity] = [splats[3], host[3]];
  const opacity = covered + (1 - covered) * hostOpacity;
  if (opacity === 0) return [0, 0, 0, 0];
  const color = [0, 1, 2].map((channel) => {
    const straight = hostOpacity > 0 ? host[channel] / hostOpacity : 0;
    const encoded = splats[channel] + (1 - covered) * encodeSrgb(straight) * hostOpacity;
    return decodeSrgb(encoded / opacity) * opacity;
  });
  return [...color, opacity];
}

/** The pixel and its eight neighbours, row by row; beyond a border, the nearest ones. */
function neighborhood(pixel: number, { widthPx, heightPx }: SizePx): number[] {
  const [x, y] = [pixel % widthPx, Math.floor(pixel / widthPx)];
  const clamped = (value: number, size: number) => Math.max(0, Math.min(size - 1, value));
  return [-1, 0, 1].flatMap((dy) =>
    [-1, 0, 1].map((dx) => clamped(y + dy, heightPx) * widthPx + clamped(x + dx, widthPx)),
  );
}

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

/**
 * Reference of upscale: bilinear between the middles of pixels, constant beyond the outermost.
 *
 * @param values image of size `from`, top row first, with any number of values per pixel.
 * @returns image of size `to`, with as many values per pixel.
 */
export function upscale(values: ArrayLike<number>, from: SizePx, to: SizePx): Float64Array {
  const channels = values.length / (from.widthPx * from.heightPx);
  const upscaled = new Float64Array(channels * to.widthPx * to.heightPx);
  for (let row = 0; row < to.heightPx; row++) {
    const [top, bottom, down] = neighbors(row, to.heightPx, from.heightPx);
    for (let column = 0; column < to.widthPx; column++) {
      const [left, right, along] = neighbors(column, to.widthPx, from.widthPx);
      for (let channel = 0; channel < channels; channel++) {
        const at = (x: number, y: number) => values[channels * (y * from.widthPx + x) + channel];
        const above = at(left, top) * (1 - along) + at(right, top) * along;
        const below = at(left, bottom) * (1 - along) + at(right, bottom) * along;
        upscaled[channels * (row * to.widthPx + column) + channel] = above * (1 - down) + below * down;
      }
    }
  }
  return upscaled;
}

/**
 * Finds the two of `smallPx` pixels whose middles surround the middle of pixel `index` of `sizePx`,
 * and the second one's weight.
 */
function neighbors(
  index: number,
  sizePx: number,
  smallPx: number,
): [low: number, high: number, weight: number] {
  const place = Math.max(0, Math.min(smallPx - 1, ((index + 0.5) * smallPx) / sizePx - 0.5));
  const low = Math.floor(place);
  return [low, Math.min(low + 1, smallPx - 1), place - low];
}
