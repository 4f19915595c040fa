import { afterEach, describe, expect, test, vi } from 'vitest';
import { browserDecoder } from './browser-webp.ts';
import { decodeWebp, openWebp, type WebpImage } from './webp.ts';

afterEach(() => {
  vi.unstubAllGlobals();
});

/** Another image than the probe: two pixels, without the hint that they are not opaque. */
const IMAGE: WebpImage = {
  file: 'a.webp',
  data: Uint8Array.of(
    ...[0x2f, 0x01, 0x00, 0x00, 0x00, 0xf8, 0x00, 0xe0, 0x15, 0x90, 0xdf, 0x34],
    ...[0x78, 0x00, 0xa0, 0x80, 0x0f, 0x00],
  ),
  width: 2,
  height: 1,
};
const PIXELS = [10, 3, 77, 0, 200, 128, 131, 64];

interface Faults {
  readonly format?: string;
  readonly isComplete?: boolean;
  readonly width?: number;
  /** Changes R, G, B, A of all pixels. */
  readonly change?: (rgba: Uint8Array) => void;
  /** Number of the image that fails, from 0. */
  readonly failsAt?: number;
}

/** Stands in for the browser's decoder, with `faults`. */
function stubDecoder({ format = 'BGRA', isComplete = true, width, change, failsAt }: Faults = {}) {
  const calls = { made: 0, closed: 0, framesClosed: 0 };
  class FakeDecoder {
    readonly #image: WebpImage;
    readonly #number = calls.made++;

    constructor({ data, type }: { data: Uint8Array; type: string }) {
      expect(type).toBe('image/webp');
      this.#image = openWebp(data, 'given');
    }

    async decode() {
      if (this.#number === failsAt) throw new DOMException('no', 'EncodingError');
      const rgba = decodeWebp(this.#image);
      // Some go by the hint of the header.
      if ((this.#image.data[4] & 0x10) === 0) for (let i = 3; i < rgba.length; i += 4) rgba[i] = 255;
      change?.(rgba);
      const image = {
        format,
        codedWidth: width ?? this.#image.width,
        codedHeight: this.#image.height,
        copyTo: async (into: Int32Array, { layout }: { layout: { offset: number; stride: number }[] }) => {
          expect(layout).toEqual([{ offset: 0, stride: 4 * this.#image.width }]);
          const bytes = new Uint8Array(into.buffer);
          bytes.set(rgba);
          for (let i = 0; i < bytes.length && format.startsWith('B'); i += 4)
            [bytes[i], bytes[i + 2]] = [bytes[i + 2], bytes[i]];
          for (let i = 3; i < bytes.length && format.endsWith('X'); i += 4) bytes[i] = 17;
        },
        close: () => {
          calls.framesClosed++;
        },
      };
      return { image, complete: isComplete };
    }

    close() {
      calls.closed++;
    }
  }
  vi.stubGlobal('ImageDecoder', FakeDecoder);
  return calls;
}

describe('images decoded by the browser', () => {
  test.each(['BGRA', 'RGBA'])('are those of our own decoder, from frames of %s', async (format) => {
    const calls = stubDecoder({ format });
    const decode = await browserDecoder();
    expect([...(await decode!(IMAGE))!]).toEqual(PIXELS);
    expect([...decodeWebp(IMAGE)]).toEqual(PIXELS);
    expect(calls).toEqual({ made: 2, closed: 2, framesClosed: 2 });
  });

  test('are asked for once, as long as it is the same decoder', async () => {
    const calls = stubDecoder();
    const both = await Promise.all([browserDecoder(), browserDecoder()]);
    expect(both[0]).toBe(both[1]);
    expect(await browserDecoder()).toBe(both[0]);
    expect(calls.made).toBe(1);
    stubDecoder({ failsAt: 0 });
    expect(await browserDecoder()).toBeNull();
  });

  test('are none where there is no such decoder', async () => {
    vi.stubGlobal('ImageDecoder', undefined);
    expect(await browserDecoder()).toBeNull();
  });

  test.each<[string, Faults]>([
    ['multiplies colours by opacities', { change: (rgba) => premultiply(rgba) }],
    ['shows faint pixels as black', { change: (rgba) => rgba[3] === 0 && rgba.fill(0, 0, 3) }],
    ['converts colours', { change: (rgba) => rgba[4]-- }],
    ['knows no opacities', { format: 'BGRX' }],
    ['gives frames that are no bytes of pixels', { format: 'I420' }],
    ['gives a part of the image', { isComplete: false }],
    ['gives another size', { width: 5 }],
    ['fails', { failsAt: 0 }],
  ])('are none where the browser %s', async (_, faults) => {
    const calls = stubDecoder(faults);
    expect(await browserDecoder()).toBeNull();
    expect(calls.closed).toBe(1);
  });

  test('are null where one fails', async () => {
    stubDecoder({ failsAt: 1 });
    expect(await (await browserDecoder())!(IMAGE)).toBeNull();
  });
});

function premultiply(rgba: Uint8Array): void {
  for (let i = 0; i < rgba.length; i++) if (i % 4 < 3) rgba[i] = (rgba[i] * rgba[(i & ~3) + 3]) / 255;
}
