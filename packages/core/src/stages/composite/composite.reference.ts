/**
 * Reference of composite: premultiplied RGBA over an opaque background, in the space that it was
 * blended in.
 *
 * @param layer 4 values per pixel.
 * @returns 4 values per pixel, opacity 1.
 */
export function composite(
  layer: ArrayLike<number>,
  background: readonly [number, number, number],
): Float64Array {
  const image = new Float64Array(layer.length);
  for (let at = 0; at < layer.length; at += 4) {
    const through = 1 - layer[at + 3];
    for (let channel = 0; channel < 3; channel++) {
      image[at + channel] = layer[at + channel] + through * background[channel];
    }
    image[at + 3] = 1;
  }
  return image;
}
