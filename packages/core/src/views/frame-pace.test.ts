import { describe, expect, test } from 'vitest';
import { type StageTimings, wallClockTimings } from '../gpu/timing/frame-statistics.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { FramePace, type MovingFrame, type PacedFrame } from './frame-pace.ts';

const IN_SIGHT = 1_000_000;
const TARGET_MS = 10;
const FULL: MovingFrame = { detail: 'full', movingScale: 1 };

/** A frame with all splats and pixels, as at rest. */
function wholeFrame(timing: StageTimings): PacedFrame {
  return { drawn: 'full', movingScale: 1, inSight: IN_SIGHT, visibleSplats: IN_SIGHT, timing };
}

/** Time of a frame with so many splats, in a part of the width and height. */
type Device = (splats: number, movingScale: number, frame: number) => number;

/** Draws frames on a device; returns the splats and the scale of every frame. */
function drawnFrames(pace: FramePace, frames: number, msOf: Device) {
  return Array.from({ length: frames }, (_, frame) => {
    const { detail, movingScale } = pace.moving;
    const splats = detail === 'full' ? IN_SIGHT : Math.min(detail.maxSplats!, IN_SIGHT);
    const timing = wallClockTimings(msOf(splats, movingScale, frame));
    pace.addFrame({ drawn: detail, movingScale, inSight: IN_SIGHT, visibleSplats: splats, timing });
    return { splats, movingScale };
  });
}

/** The splats of frames on a device whose time does not depend on pixels. */
function drawn(pace: FramePace, frames: number, msOf: (splats: number, frame: number) => number): number[] {
  const all = drawnFrames(pace, frames, (splats, _, frame) => msOf(splats, frame));
  return all.map(({ splats }) => splats);
}

describe('FramePace', () => {
  test('draws all splats where that is in time', () => {
    const pace = new FramePace(TARGET_MS);
    expect(new Set(drawn(pace, 20, () => 9.9))).toEqual(new Set([IN_SIGHT]));
    expect(pace.moving).toEqual(FULL);
  });

  test.each([[1e-5], [5e-5], [1e-3]])(
    'finds what a device draws in time that takes %f ms each',
    (splatMs) => {
      const pace = new FramePace(TARGET_MS);
      const splats = drawn(pace, 40, (count) => 1 + splatMs * count);
      const last = splats.slice(-10);
      expect(new Set(last).size).toBe(1);
      expect(1 + splatMs * last[0]).toBeLessThanOrEqual(TARGET_MS);
      expect(1 + splatMs * last[0]).toBeGreaterThan(0.5 * TARGET_MS);
    },
  );

  test('is not misled by single slow frames, and follows two', () => {
    const pace = new FramePace(TARGET_MS);
    drawn(pace, 20, (_, frame) => (frame % 2 === 0 ? 100 : 5));
    expect(pace.moving).toEqual(FULL);
    drawn(pace, 2, () => 100);
    expect(pace.moving).toEqual({ detail: { maxSplats: 80_000 }, movingScale: 1 });
  });

  test('grows step by step when frames become quick, until all splats are drawn', () => {
    const pace = new FramePace(TARGET_MS);
    drawn(pace, 30, (splats) => 1e-4 * splats);
    const grown = drawn(pace, 20, (splats) => 1e-6 * splats);
    for (const [i, splats] of grown.entries())
      if (i > 0) expect(splats).toBeLessThanOrEqual(Math.ceil(1.5 * grown[i - 1]));
    expect(grown.at(-1)).toBe(IN_SIGHT);
  });

  test('draws all splats where fewer take as long', () => {
    const pace = new FramePace(TARGET_MS);
    drawn(pace, 60, () => 100);
    expect(pace.moving).toEqual(FULL);
    // Half of the time is that of the splats, which a tenth of them reduce to little.
    const splats = drawn(new FramePace(TARGET_MS), 60, (count) => 100 + 1e-4 * count);
    expect(splats.at(-1)).toBeGreaterThan(300_000);
  });

  test('never draws next to nothing', () => {
    const pace = new FramePace(TARGET_MS);
    drawn(pace, 20, (splats) => splats);
    expect(pace.moving).toEqual({ detail: { maxSplats: 1000 }, movingScale: 1 });
  });

  test('heeds timestamps where there are some, and frames that show nothing', () => {
    const quick = new FramePace(TARGET_MS);
    const stages = { preprocessMs: 1, sortMs: 1, rasterizeMs: 1 };
    const timing = { ...wallClockTimings(500), source: 'gpu-timestamps', ...stages } as const;
    for (let i = 0; i < 3; i++) quick.addFrame(wholeFrame(timing));
    expect(quick.moving).toEqual(FULL);
    quick.addFrame({ ...wholeFrame(timing), visibleSplats: 0 });
    expect(quick.moving).toEqual(FULL);
  });

  /** Of a device with few pixels a millisecond. */
  const pixelBound =
    (pixelsMs: number, fixedMs: number, splatMs: number): Device =>
    (splats, scale) =>
      fixedMs + pixelsMs * scale ** 2 + splatMs * splats;

  test('draws in a quarter of the pixels where these take too long, and more splats in their stead', () => {
    const pace = new FramePace(TARGET_MS);
    const device = pixelBound(20, 0.5, 1e-5);
    const frames = drawnFrames(pace, 60, device);
    const { splats, movingScale } = frames.at(-1)!;
    expect(movingScale).toBe(0.5);
    expect(device(splats, movingScale, 0)).toBeLessThanOrEqual(TARGET_MS);
    expect(splats).toBeGreaterThan(50_000);
    expect(new Set(frames.slice(-10).map((frame) => frame.splats)).size).toBe(1);
  });

  test('keeps the resolution where fewer pixels would not help, and tries them once', () => {
    const pace = new FramePace(TARGET_MS);
    const frames = drawnFrames(pace, 100, pixelBound(0.5, 50, 1e-4));
    const lower = frames.flatMap(({ movingScale }, i) => (movingScale < 1 ? [i] : []));
    expect(lower.length).toBeGreaterThan(0);
    expect(lower.length).toBeLessThan(5);
    expect(pace.moving.movingScale).toBe(1);
  });

  test('comes back to all pixels when they take less, or a picture at rest is in time', () => {
    const pace = new FramePace(TARGET_MS);
    drawnFrames(pace, 60, pixelBound(100, 0.5, 1e-5));
    expect(pace.moving.movingScale).toBe(0.5);
    drawnFrames(pace, 20, pixelBound(4, 0.2, 1e-7));
    expect(pace.moving).toEqual(FULL);

    const other = new FramePace(TARGET_MS);
    drawnFrames(other, 60, pixelBound(100, 0.5, 1e-5));
    other.addFrame(wholeFrame(wallClockTimings(9)));
    expect(other.moving).toEqual(FULL);
  });

  test('finds what a device draws in time of a scene whose parts are missing at first', () => {
    const pace = new FramePace(TARGET_MS);
    let visibleSplats = 0;
    for (let frame = 0; frame < 60; frame++) {
      const { detail, movingScale } = pace.moving;
      const { maxSplats = IN_SIGHT } = detail === 'full' ? {} : detail;
      const present = 5000 * (frame + 1);
      visibleSplats = Math.min(present, 0.7 * maxSplats);
      const timing = wallClockTimings(1 + 1e-4 * visibleSplats);
      pace.addFrame({ drawn: detail, movingScale, inSight: IN_SIGHT, visibleSplats, timing });
    }
    expect(visibleSplats).toBeGreaterThan(50_000);
    expect(visibleSplats).toBeLessThanOrEqual(90_000);
  });

  test('leaves pictures at rest out of its estimates of smaller ones', () => {
    const pace = new FramePace(TARGET_MS);
    drawnFrames(pace, 60, pixelBound(100, 0.5, 1e-5));
    const before = pace.moving;
    for (let frame = 0; frame < 5; frame++) pace.addFrame(wholeFrame(wallClockTimings(500)));
    expect(pace.moving).toEqual(before);
  });

  test('draws fewer splats again where a busy time had told that they gain nothing', () => {
    const pace = new FramePace(TARGET_MS);
    // As if other work slowed the frames with fewer splats.
    drawn(pace, 40, (splats) => (splats === IN_SIGHT ? 900 : 1000));
    expect(pace.moving.detail).toBe('full');
    const splats = drawn(pace, 100, (count) => 1e-3 * count);
    expect(splats.at(-1)).toBeLessThanOrEqual(10_000);
  });

  test('keeps a budget for which time is lacking anyhow, though estimates waver', () => {
    const pace = new FramePace(TARGET_MS);
    const random = seededRandom(3);
    const device = pixelBound(40, 60, 1e-4);
    const frames = drawnFrames(pace, 120, (...frame) => (0.9 + 0.2 * random()) * device(...frame));
    const counts = frames.slice(-60).map(({ splats }) => splats);
    expect(new Set(counts).size).toBeLessThan(10);
    for (const splats of counts) expect(splats).toBeGreaterThan(100_000);
  });
});
