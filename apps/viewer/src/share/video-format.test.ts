import { afterEach, expect, test, vi } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import { pathOf, viewOnPath } from '../navigate/view-path.ts';
import { FIRST_PATH, type SavedView } from '../state/saved-view.ts';
import { codecNames, FRAME_RATES, findCodec, frameCount, videoSize, withQuality } from './video-format.ts';

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
  expect(await findCodec('webm', [1920, 1080], 30)).toMatchObject({
    name: 'vp9',
    config: { width: 1920, height: 1080, framerate: 30 },
  });
  encode('av01');
  expect((await findCodec('webm', [1920, 1080], 30))?.name).toBe('av1');
  encode('vp8');
  expect((await findCodec('webm', [1920, 1080], 30))?.name).toBe('vp8');
});

test('there is none where a browser encodes nothing of that, or has no encoder', async () => {
  encode();
  expect(await findCodec('webm', [1920, 1080], 30)).toBeNull();
  vi.unstubAllGlobals();
  expect(await findCodec('webm', [1920, 1080], 30)).toBeNull();
});

test('small videos have bits enough for edges', async () => {
  encode('vp09');
  expect((await findCodec('webm', [240, 160], 30))?.config.bitrate).toBe(1e6);
  expect((await findCodec('webm', [3840, 2160], 60))?.config.bitrate).toBeGreaterThan(5e7);
});

test('MP4 has H.264 first, also without its High profile, and other codecs where that is missing', async () => {
  encode('avc1.64', 'av01');
  const high = await findCodec('mp4', [1280, 720], 60);
  expect(high).toMatchObject({ container: 'mp4', name: 'avc', config: { codec: 'avc1.640034' } });
  encode('avc1.42');
  expect((await findCodec('mp4', [1280, 720], 60))?.config.codec).toBe('avc1.420034');
  encode('vp09');
  expect((await findCodec('mp4', [1280, 720], 60))?.words).toBe('VP9');
  encode('vp8');
  expect(await findCodec('mp4', [1280, 720], 60)).toBeNull();
  expect(codecNames('mp4')).toBe('H.264, AV1, and VP9');
});

test('a better quality has more bits', async () => {
  encode('vp09');
  const codec = (await findCodec('webm', [1920, 1080], 30))!;
  const [small, good, best] = (['small', 'good', 'best'] as const).map(
    (quality) => withQuality(codec, quality).config.bitrate,
  );
  expect(good).toBe(codec.config.bitrate);
  expect(small).toBeLessThan(good / 2);
  expect(best).toBeGreaterThan(2 * good);
});

test.each(FRAME_RATES)('at %d frames a second, each view of a path has a frame of its own', (rate) => {
  const savedViews = [0, 1, 2, 3].map(
    (azimuth): SavedView => ({
      ...{ pose: { ...FRONT, azimuth }, fovDegrees: 50, isOrthographic: false },
      ...{ isFlipped: false, isZUp: false, name: '', thumbnail: null },
    }),
  );
  const path = pathOf({ savedViews, path: FIRST_PATH })!;
  const count = frameCount(path, rate);
  expect(count).toBe(7.5 * rate + 1);
  for (const view of [0, 1, 2, 3]) {
    const { pose } = viewOnPath(path, (view * 2.5 * rate * 1000) / rate);
    expect(pose.azimuth).toBeCloseTo(view, 9);
  }
  // Played again and again, a loop shows no frame twice.
  expect(frameCount({ durationMs: 10_000, isLooped: true }, rate)).toBe(10 * rate);
});

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
