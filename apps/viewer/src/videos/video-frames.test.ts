import { expect, test } from 'vitest';
import { FRAME_RATES, frameCount, placeOfFrame, videoSize } from './video-frames.ts';

test.each(FRAME_RATES)('at %d frames a second they lie evenly on the path, with both ends', (rate) => {
  const views = 4;
  const count = frameCount(views, rate);
  expect(count).toBe(7.5 * rate + 1);
  const places = Array.from({ length: count }, (_, frame) => placeOfFrame(frame, views, rate));
  expect([places[0], places[count - 1]]).toEqual([0, 3]);
  for (let i = 1; i < count; i++) expect(places[i] - places[i - 1]).toBeCloseTo(1 / (2.5 * rate), 9);
  // Each view has a frame of its own.
  for (const view of [1, 2]) expect(places[view * 2.5 * rate]).toBe(view);
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
