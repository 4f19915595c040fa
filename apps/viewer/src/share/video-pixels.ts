/** What players take videos for, whether or not they read what the file says. */
export const VIDEO_COLORS = {
  fullRange: false,
  matrix: 'bt709',
  primaries: 'bt709',
  transfer: 'bt709',
} as const satisfies VideoColorSpaceInit;

/** How much each channel adds to the brightness. */
const [RED, GREEN, BLUE] = [0.2126, 0.7152, 0.0722];
/** Black, and grey in both differences; the range of either, for channels of 255 steps. */
const [DARKEST, MIDDLE] = [16, 128];
const BRIGHTNESS_SCALE = 219 / 255;
const BLUE_SCALE = 224 / 255 / (2 * (1 - BLUE));
const RED_SCALE = 224 / 255 / (2 * (1 - RED));

/**
 * Converts an image to I420 in `VIDEO_COLORS`: its brightness, then its blue and its red difference
 * for two by two pixels. Browsers would convert it themselves, but Chromium then uses the full
 * range of bytes, which Firefox shows with too much contrast.
 *
 * @param pixels RGBA of an opaque image, top row first, of even width and height.
 */
export function i420Of(
  pixels: Uint8ClampedArray,
  widthPx: number,
  heightPx: number,
): Uint8ClampedArray<ArrayBuffer> {
  const count = widthPx * heightPx;
  const planes = new Uint8ClampedArray((count * 3) / 2);
  let blueAt = count;
  let redAt = count + count / 4;
  for (let y = 0; y < heightPx; y += 2) {
    for (let x = 0; x < widthPx; x += 2) {
      const corner = y * widthPx + x;
      let [red, blue, bright] = [0, 0, 0];
      for (let i = 0; i < 4; i++) {
        const at = corner + (i & 1) + (i >> 1) * widthPx;
        const brightness = RED * pixels[4 * at] + GREEN * pixels[4 * at + 1] + BLUE * pixels[4 * at + 2];
        planes[at] = DARKEST + BRIGHTNESS_SCALE * brightness;
        red += pixels[4 * at];
        blue += pixels[4 * at + 2];
        bright += brightness;
      }
      planes[blueAt++] = MIDDLE + (BLUE_SCALE * (blue - bright)) / 4;
      planes[redAt++] = MIDDLE + (RED_SCALE * (red - bright)) / 4;
    }
  }
  return planes;
}
