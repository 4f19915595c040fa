import { afterEach, expect, test, vi } from 'vitest';
import { findCodec } from './video-codec.ts';

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
