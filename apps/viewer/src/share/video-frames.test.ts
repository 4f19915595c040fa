import { expect, test } from 'vitest';
import { placeOnPath } from '../navigate/view-path.ts';
import { FRAME_RATES, frameCount, videoSize } from './video-frames.ts';

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
