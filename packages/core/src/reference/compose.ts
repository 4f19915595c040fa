import { decodeSrgb, encodeSrgb } from './srgb.ts';

/**
 * Twin of the GPU's compose: splats over what another renderer has drawn.
 *
 * @param layer blended splats, premultiplied, sRGB-encoded, 4 values per pixel.
 * @param behind the host's colours, premultiplied, linear, 4 values per pixel.
 * @returns linear, premultiplied, 4 values per pixel; all 0 where there is no splat.
 */
export function compose(layer: ArrayLike<number>, behind: ArrayLike<number>): Float64Array {
  const picture = new Float64Array(layer.length);
  for (let at = 0; at < layer.length; at += 4) {
    const covered = layer[at + 3];
    if (covered === 0) continue;
    const hostOpacity = behind[at + 3];
    const opacity = covered + (1 - covered) * hostOpacity;
    for (let channel = at; channel < at + 3; channel++) {
      const straight = hostOpacity > 0 ? behind[channel] / hostOpacity : 0;
      const encoded = layer[channel] + (1 - covered) * encodeSrgb(straight) * hostOpacity;
      picture[channel] = decodeSrgb(encoded / opacity) * opacity;
    }
    picture[at + 3] = opacity;
  }
  return picture;
}
