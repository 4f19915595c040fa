import { toRgba } from './vp8l.ts';
import type { WebpImage } from './webp.ts';

const RIFF_HEADER_BYTES = 20;
/** The alpha bit in the fifth byte of a coded image. Browsers may treat images without it as opaque. */
const ALPHA_HINT = { byte: 4, bit: 0x10 } as const;

/**
 * A coded image of 4 × 4 pixels with one bit per channel and pixel, so that the pixels count from 0
 * to 15. A browser that premultiplies alpha or converts colours changes some pixels.
 */
const PROBE = Uint8Array.of(
  ...[0x2f, 0x03, 0xc0, 0x00, 0x10, 0xf8, 0x00, 0xe0, 0x15, 0x90, 0xdf, 0x34],
  ...[0x78, 0x00, 0xa0, 0x80, 0x90, 0xa1, 0xb2, 0xc3, 0xd4, 0xe5, 0xf6, 0x07],
);
const PROBE_SIDE = 4;

/** Cached probe results, by decoder class, because a page may replace the browser's own. */
const probed = new WeakMap<typeof ImageDecoder, Promise<typeof decode | null>>();

/**
 * Returns a decoder of lossless images that uses the browser's threads; null if the browser has no
 * exact one. Its bytes equal the output of `decodeWebp`. An image that fails to decode gives null.
 *
 * WebCodecs frames are not premultiplied and are copied unchanged. A canvas or texture would lose
 * the colours of faint pixels, or make them depend on the browser.
 *
 * The probe runs once. The promise never rejects, so callers may await it late.
 */
export async function browserDecoder(): Promise<typeof decode | null> {
  if (typeof ImageDecoder === 'undefined') return null;
  const known = probed.get(ImageDecoder);
  if (known) return known;
  const found = probe();
  probed.set(ImageDecoder, found);
  return found;
}

async function probe(): Promise<typeof decode | null> {
  const found = await decode({ data: PROBE, width: PROBE_SIDE, height: PROBE_SIDE });
  return found && probePixels().every((value, i) => found[i] === value) ? decode : null;
}

/** R, G, B, A of each pixel of `PROBE`. */
function probePixels(): number[] {
  return Array.from({ length: PROBE_SIDE ** 2 }, (_, pixel) => {
    const either = (bit: number, off: number, on: number) => ((pixel >> bit) & 1 ? on : off);
    return [either(1, 10, 200), either(0, 3, 128), either(2, 77, 131), either(3, 0, 64)];
  }).flat();
}

async function decode({
  data,
  width,
  height,
}: Pick<WebpImage, 'data' | 'width' | 'height'>): Promise<Uint8Array<ArrayBuffer> | null> {
  const strideBytes = 4 * width;
  try {
    const file = webpOf(data);
    const decoder = new ImageDecoder({
      data: file,
      transfer: [file.buffer],
      type: 'image/webp',
      colorSpaceConversion: 'none',
    });
    try {
      const { image: frame, complete } = await decoder.decode();
      try {
        const { format, codedWidth, codedHeight } = frame;
        if (!complete || codedWidth !== width || codedHeight !== height) return null;
        const pixels = new Int32Array(width * height);
        const layout = [{ offset: 0, stride: strideBytes }];
        // In the frame's own channel order: for other orders, Chromium premultiplies alpha.
        await frame.copyTo(pixels, { layout });
        if (format === 'RGBA') return new Uint8Array(pixels.buffer);
        return format === 'BGRA' ? toRgba(pixels) : opaque(format, pixels);
      } finally {
        frame.close();
      }
    } finally {
      decoder.close();
    }
  } catch {
    // Null: the fallback decoder tries, and reports the image's faults.
    return null;
  }
}

/**
 * Sets the undefined fourth channel of opaque formats to 255. Null for formats without four bytes
 * per pixel.
 */
function opaque(format: VideoPixelFormat | null, pixels: Int32Array<ArrayBuffer>) {
  if (format !== 'RGBX' && format !== 'BGRX') return null;
  for (let i = 0; i < pixels.length; i++) pixels[i] |= 0xff000000;
  return format === 'BGRX' ? toRgba(pixels) : new Uint8Array(pixels.buffer);
}

/** A WebP file with the image alone, without colour profile and orientation. */
function webpOf(data: Uint8Array): Uint8Array<ArrayBuffer> {
  const paddedBytes = data.length + (data.length & 1);
  const file = new Uint8Array(RIFF_HEADER_BYTES + paddedBytes);
  const view = new DataView(file.buffer);
  file.set(new TextEncoder().encode('RIFF    WEBPVP8L'));
  view.setUint32(4, RIFF_HEADER_BYTES - 8 + paddedBytes, true);
  view.setUint32(16, data.length, true);
  file.set(data, RIFF_HEADER_BYTES);
  file[RIFF_HEADER_BYTES + ALPHA_HINT.byte] |= ALPHA_HINT.bit;
  return file;
}
