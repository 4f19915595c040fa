import { afterEach, expect, test, vi } from 'vitest';
import { placeOnPath } from '../navigate/view-path.ts';
import { FRAME_RATES, findCodec, frameCount, videoSize } from './video-format.ts';

afterEach(() => vi.unstubAllGlobals());

/** A browser that encodes the codecs whose names begin so, and cannot read others. */
const encode = (...supported: string[]) =>
  vi.stubGlobal('VideoEncoder', {
    isConfigSupported: async ({ codec }: VideoEncoderConfig) => {
      if (supported.some((each) => codec.startsWith(each))) return { supported: true };
      if (codec === 'vp8') return { supported: false };
      throw new TypeError(`${codec} is unknown`);
    },
  });

test('VP9 is taken where a browser has several codecs, and any other where it has that alone', async () => {
  encode('vp09', 'av01', 'vp8');
  expect(await findCodec([1920, 1080], 30)).toMatchObject({
    name: 'vp9',
    config: { width: 1920, height: 1080, framerate: 30 },
  });
  encode('av01');
  expect((await findCodec([1920, 1080], 30))?.name).toBe('av1');
  encode('vp8');
  expect((await findCodec([1920, 1080], 30))?.name).toBe('vp8');
});

test('there is none where a browser encodes nothing of that, or has no encoder', async () => {
  encode();
  expect(await findCodec([1920, 1080], 30)).toBeNull();
  vi.unstubAllGlobals();
  expect(await findCodec([1920, 1080], 30)).toBeNull();
});

test('small videos have bits enough for edges', async () => {
  encode('vp09');
  expect((await findCodec([240, 160], 30))?.config.bitrate).toBe(1e6);
  expect((await findCodec([3840, 2160], 60))?.config.bitrate).toBeGreaterThan(5e7);
});

test.each(FRAME_RATES)(
  'at %d frames a second they are on the path from its first view to its last',
  (rate) => {
    const views = 4;
    const count = frameCount(views, rate);
    expect(count).toBe(7.5 * rate + 1);
    const places = Array.from({ length: count }, (_, frame) => placeOnPath((frame * 1000) / rate, views));
    // Each view has a frame of its own.
    for (const view of [0, 1, 2, 3]) expect(places[view * 2.5 * rate]).toBeCloseTo(view, 9);
  },
);

test.each([
  [null, [900, 600], [900, 600]],
  [null, [901, 601], [900, 600]],
  [null, [1, 1], [2, 2]],
  [null, [5120, 1440], [4096, 1152]],
  [1080, [900, 600], [1920, 1080]],
  [1080, [360, 640], [1080, 1920]],
  [2160, [900, 600], [3840, 2160]],
] as const)('a video of %j lines of a window of %j px has %j px', (lines, window, size) => {
  expect(videoSize(lines, window)).toEqual(size);
});

test('a video of a large square window has as many pixels as encoders take', () => {
  const [widthPx, heightPx] = videoSize(null, [4000, 4000]);
  expect(widthPx).toBe(heightPx);
  expect(widthPx * heightPx).toBeLessThanOrEqual(2 ** 23);
  expect((widthPx + 2) ** 2).toBeGreaterThan(2 ** 23);
});
