import { toRgba } from './vp8l.ts';
import type { WebpImage } from './webp.ts';

const RIFF_HEADER_BYTES = 20;
/** A bit of a coded image's fifth byte, which browsers may go by: not all of it is opaque. */
const ALPHA_HINT = { byte: 4, bit: 0x10 } as const;

/**
 * An image of 4 × 4 pixels, coded: one bit for each channel of each pixel, so that the pixels count
 * from 0 to 15. A browser that multiplies colours by opacities, or converts them, changes some.
 */
const PROBE = Uint8Array.of(
  ...[0x2f, 0x03, 0xc0, 0x00, 0x10, 0xf8, 0x00, 0xe0, 0x15, 0x90, 0xdf, 0x34],
  ...[0x78, 0x00, 0xa0, 0x80, 0x90, 0xa1, 0xb2, 0xc3, 0xd4, 0xe5, 0xf6, 0x07],
);
const PROBE_SIDE = 4;

/** Results of probes, by the decoder probed: other code may take the place of the browser's own. */
const probed = new WeakMap<typeof ImageDecoder, Promise<typeof decode | null>>();

/**
 * Returns a decoder of lossless images by the browser, several at once in threads of its own, to
 * the very bytes that `decodeWebp` gives; null where the browser has none. An image's result is
 * null where it fails.
 *
 * It uses WebCodecs, whose frames are not premultiplied and are copied as they are. A canvas or a
 * texture would lose colours of faint pixels, or make them depend on the browser.
 *
 * Probes once. Never rejects: callers need not wait before there are images.
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
        // As the frame has them: asked for another order, Chromium multiplies colours by opacities.
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
    // Our own decoder reports any fault of the image.
    return null;
  }
}

/** The fourth channel of opaque formats is undefined. Null for formats without four bytes. */
function opaque(format: VideoPixelFormat | null, pixels: Int32Array<ArrayBuffer>) {
  if (format !== 'RGBX' && format !== 'BGRX') return null;
  for (let i = 0; i < pixels.length; i++) pixels[i] |= 0xff000000;
  return format === 'BGRX' ? toRgba(pixels) : new Uint8Array(pixels.buffer);
}

/** A file with nothing but the image: no profile of colours, and no turn. */
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
