import { describe, expect, onTestFinished, test } from 'vitest';
import type { CloudSight } from './cloud-sight.ts';
import { OwnFrames, PACES, PartPace, SceneViewers } from './scene-viewers.ts';

const CUT = { camera: [0, 0, 2], squaredPerDistance: 1e-9, leastSquared: 1e-12, margin: 0 } as const;
const side = () => ({ normal: [1, 0, 0], offset: 1, reach: 3 }) as const;
/** New objects, as each frame makes. */
const sight = (cut: Partial<CloudSight['cut']> = {}, squaredShift = 1): CloudSight => ({
  cut: { ...CUT, ...cut },
  squaredShift,
  sides: [side()],
});

test('sights are the same arrays until a view sees something else, so that plans stay', () => {
  const views = new SceneViewers(
    async () => {},
    () => {},
  );
  onTestFinished(() => views.end());
  const view = {};
  const after = (next: CloudSight) => {
    views.set(view, [next], async () => {});
    return [views.sights, views.predicted];
  };
  const [sights, predicted] = after(sight());
  for (let frame = 0; frame < 3; frame++) {
    const [next, nextPredicted] = after(sight());
    expect(next).toBe(sights);
    expect(nextPredicted).toBe(predicted);
  }
  for (const other of [sight({ squaredPerDistance: 1 }), sight({}, 2), sight({ camera: [0, 0, 3] })]) {
    const [before] = after(sight());
    expect(after(other)[0]).not.toBe(before);
  }
});

/** Draws so many frames, each of which takes the device a while, with pauses between them. */
function framesOf(frames: number, frameMs: number, pauseMs: number) {
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
  const { own, endMs } = framesOf(1, 5, 0);
  expect(own.restMs(endMs)).toBe(0);
});

test.each([
  ['a quick device', 5, 11, 50],
  ['a slow device', 4000, 2, 50],
  ['a slow host', 5, 300, 600],
])('frame follows frame: %s', (_, frameMs, pauseMs, restMs) => {
  const { own, endMs } = framesOf(3, frameMs, pauseMs);
  expect(own.stepMs).toBe(frameMs + pauseMs);
  expect(own.restMs(endMs)).toBe(restMs);
  expect(own.restMs(endMs + restMs - 1)).toBe(1);
  expect(own.restMs(endMs + restMs)).toBe(0);
});

test('frames now and then follow nothing', () => {
  const { own, endMs } = framesOf(3, 5, 700);
  expect(own.restMs(endMs)).toBe(0);
});

test('a view is not at rest while the device draws its next frame', () => {
  const { own, endMs } = framesOf(1, 5, 0);
  own.begin(endMs + 10);
  expect(own.restMs(endMs + 90_000)).toBeGreaterThan(0);
  // Asked for before that was done.
  own.begin(endMs + 90_000);
  own.end(endMs + 91_000);
  expect(own.restMs(endMs + 99_000)).toBeGreaterThan(0);
  own.end(endMs + 99_000);
  expect(own.restMs(endMs + 99_050)).toBe(0);
});

const STEP_MS = 16;

/** Frames of a device, with as many parts before each as the pace allows; returns these numbers. */
function draw(pace: PartPace, frames: number, frameMs: (parts: number, frame: number) => number): number[] {
  const parts: number[] = [];
  for (let frame = 0; frame < frames; frame++) {
    const { parts: most } = pace.limit;
    parts.push(most);
    pace.addFrame(most, frameMs(most, frame), STEP_MS);
  }
  return parts;
}

/** A pace that knows what frames take without parts. */
function paceAfter(plainMs: number): PartPace {
  const pace = new PartPace(PACES.moving);
  for (let frame = 0; frame < 10; frame++) pace.addFrame(0, plainMs, STEP_MS);
  return pace;
}

describe('the pace of parts', () => {
  test('grows by one from frame to frame while parts delay none', () => {
    expect(draw(paceAfter(5), 6, () => 5)).toEqual([1, 2, 3, 4, 5, 6]);
  });

  test('doubles where the view does not move, and parts may delay a frame by another', () => {
    expect(draw(new PartPace(PACES.still), 6, () => 5)).toEqual([1, 8, 16, 32, 64, 128]);
    const parts = draw(new PartPace(PACES.still), 100, (count) => 5 + 0.5 * count);
    expect(Math.max(...parts)).toBeGreaterThanOrEqual(32);
    // 32 take 16 ms.
    expect(parts.filter((count) => count > 32).length).toBeLessThan(0.1 * parts.length);
  });

  test('stays where parts delay frames by a quarter of the time between these', () => {
    const parts = draw(paceAfter(5), 400, (count) => 5 + 0.5 * count).slice(100);
    // Eight take 4 ms, of 16.
    expect(Math.max(...parts)).toBe(9);
    expect(parts.reduce((sum, count) => sum + count, 0) / parts.length).toBeGreaterThan(5);
    expect(parts.filter((count) => count > 8).length).toBeLessThan(0.02 * parts.length);
  });

  test('has hardly ever more than one where one takes long', () => {
    const parts = draw(paceAfter(5), 300, (count) => 5 + 10 * count);
    expect(new Set(parts)).toEqual(new Set([1, 2]));
    expect(parts.filter((count) => count > 1).length).toBeLessThan(0.05 * parts.length);
  });

  test('is halved by one late frame, and grows again, at once if nothing has come meanwhile', () => {
    const frameMs = (_: number, frame: number) => (frame === 8 ? 30 : 5);
    expect(draw(paceAfter(5), 14, frameMs).slice(7)).toEqual([8, 9, 4, 4, 5, 5, 6]);
    const pace = paceAfter(5);
    draw(pace, 9, frameMs);
    pace.addFrame(0, 5, STEP_MS);
    expect(draw(pace, 4, () => 5)).toEqual([4, 5, 6, 7]);
  });

  test('does not grow by frames with fewer parts than are allowed', () => {
    const pace = paceAfter(5);
    draw(pace, 4, () => 5);
    pace.addFrame(2, 5, STEP_MS);
    expect(pace.limit.parts).toBe(5);
  });

  test('takes a quarter of the time between frames on the thread, 1 to 4 ms', () => {
    const pace = paceAfter(5);
    const msOf = (stepMs: number) => {
      pace.addFrame(0, 5, stepMs);
      return pace.limit.ms;
    };
    expect([2, 8, 16, 33].map(msOf)).toEqual([1, 2, 4, 4]);
  });

  test('follows what frames take without parts', () => {
    const pace = paceAfter(5);
    // A scene that takes longer as more of it is there.
    for (let frame = 0; frame < 30; frame++) pace.addFrame(0, 12, STEP_MS);
    expect(draw(pace, 4, () => 12)).toEqual([1, 2, 3, 4]);
  });
});
