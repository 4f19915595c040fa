import { describe, expect, test } from 'vitest';
import { wallClockTimings } from '../gpu/timing/frame-statistics.ts';
import { FramePace } from './frame-pace.ts';

const IN_SIGHT = 1_000_000;
const TARGET_MS = 10;

/** Draws frames on a device that takes so long for each, and returns the splats of every frame. */
function drawn(pace: FramePace, frames: number, msOf: (splats: number, frame: number) => number): number[] {
  return Array.from({ length: frames }, (_, frame) => {
    const { moving } = pace;
    const splats = moving === 'full' ? IN_SIGHT : Math.min(moving.maxSplats!, IN_SIGHT);
    pace.addFrame({ drawn: moving, inSight: IN_SIGHT, timing: wallClockTimings(msOf(splats, frame)) });
    return splats;
  });
}

describe('FramePace', () => {
  test('draws all splats where that is in time', () => {
    const pace = new FramePace(TARGET_MS);
    expect(new Set(drawn(pace, 20, () => 9.9))).toEqual(new Set([IN_SIGHT]));
    expect(pace.moving).toBe('full');
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
    expect(pace.moving).toBe('full');
    drawn(pace, 2, () => 100);
    expect(pace.moving).toEqual({ maxSplats: 80_000 });
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
    expect(pace.moving).toBe('full');
    // Half of the time is that of the splats, which a tenth of them reduce to little.
    const splats = drawn(new FramePace(TARGET_MS), 60, (count) => 100 + 1e-4 * count);
    expect(splats.at(-1)).toBeGreaterThan(300_000);
  });

  test('never draws next to nothing', () => {
    const pace = new FramePace(TARGET_MS);
    drawn(pace, 20, (splats) => splats);
    expect(pace.moving).toEqual({ maxSplats: 1000 });
  });

  test('heeds timestamps where there are some, and frames that show nothing', () => {
    const quick = new FramePace(TARGET_MS);
    const stages = { preprocessMs: 1, sortMs: 1, rasterizeMs: 1 };
    const timing = { ...wallClockTimings(500), source: 'gpu-timestamps', ...stages } as const;
    for (let i = 0; i < 3; i++) quick.addFrame({ drawn: 'full', inSight: IN_SIGHT, timing });
    expect(quick.moving).toBe('full');
    quick.addFrame({ drawn: 'full', inSight: 0, timing });
    expect(quick.moving).toBe('full');
  });
});
