import { expect, test } from 'vitest';
import { OwnFrames } from './part-pace.ts';

/** Draws so many frames, each of which takes the device a while, with pauses between them. */
function draw(frames: number, frameMs: number, pauseMs: number) {
  const own = new OwnFrames();
  let nowMs = 1000;
  for (let frame = 0; frame < frames; frame++) {
    own.begin(nowMs);
    nowMs += frameMs;
    own.end(nowMs);
    nowMs += pauseMs;
  }
  return { own, endMs: nowMs - pauseMs };
}

test('one frame is followed by none', () => {
  const { own, endMs } = draw(1, 5, 0);
  expect(own.restMs(endMs)).toBe(0);
});

test.each([
  ['a quick device', 5, 11, 50],
  ['a slow device', 4000, 2, 50],
  ['a slow host', 5, 300, 600],
])('frame follows frame: %s', (_, frameMs, pauseMs, restMs) => {
  const { own, endMs } = draw(3, frameMs, pauseMs);
  expect(own.stepMs).toBe(frameMs + pauseMs);
  expect(own.restMs(endMs)).toBe(restMs);
  expect(own.restMs(endMs + restMs - 1)).toBe(1);
  expect(own.restMs(endMs + restMs)).toBe(0);
});

test('frames now and then follow nothing', () => {
  const { own, endMs } = draw(3, 5, 700);
  expect(own.restMs(endMs)).toBe(0);
});

test('a view is not at rest while the device draws its next frame', () => {
  const { own, endMs } = draw(1, 5, 0);
  own.begin(endMs + 10);
  expect(own.restMs(endMs + 90_000)).toBeGreaterThan(0);
  // Asked for before that was done.
  own.begin(endMs + 90_000);
  own.end(endMs + 91_000);
  expect(own.restMs(endMs + 99_000)).toBeGreaterThan(0);
  own.end(endMs + 99_000);
  expect(own.restMs(endMs + 99_050)).toBe(0);
});
