import { describe, expect, it } from 'vitest';
import type { Vec3 } from '../state/vec3.ts';
import { FLOOR, ground } from './boxes.fixture.ts';
import { EYES_M, standingPlace, Walker, type Walking } from './walker.ts';
import { guessedEyeHeight } from './walks.ts';

/** Across the way, from x = 2 on. */
const across = (height: number) =>
  [
    [2, 0, -4],
    [4, height, 4],
  ] as const;
const STILL: Walking = { way: [0, 0], isFast: false, isJumping: false };
const ALONG_X: Walking = { ...STILL, way: [1, 0] };
const START: Vec3 = [0, 0, 0];
const FRAME_S = 1 / 60;

function walked(walker: Walker, walking: Walking, seconds: number, frameS = FRAME_S): boolean {
  let hasFallen = false;
  for (let frame = 0; frame < Math.round(seconds / frameS); frame++)
    hasFallen = walker.advance(frameS, walking) || hasFallen;
  return hasFallen;
}

describe('a walker', () => {
  it('walks two metres in a second, at the height of the eyes, and rests when it is let go', () => {
    const walker = new Walker(ground(FLOOR), START, EYES_M);
    walked(walker, ALONG_X, 1);
    expect(walker.eyes[0]).toBeCloseTo(2, 1);
    expect(walker.eyes[1]).toBeCloseTo(EYES_M, 9);
    expect(walker.isMoving).toBe(true);
    walked(walker, STILL, 0.1);
    expect(walker.isMoving).toBe(false);
  });

  it('is three times as fast when it runs, and as large as its eyes are high', () => {
    const walker = new Walker(ground(FLOOR), START, EYES_M / 4);
    walked(walker, { ...ALONG_X, isFast: true }, 1);
    expect(walker.eyes[0]).toBeCloseTo(1.5, 1);
    expect(walker.eyes[1]).toBeCloseTo(EYES_M / 4, 9);
  });

  it('climbs a step of 0.25 smoothly', () => {
    const walker = new Walker(ground(FLOOR, across(0.25)), [1, 0, 0], EYES_M);
    let highest = 0;
    for (let frame = 0; frame < 60; frame++) {
      const before = walker.eyes[1];
      walker.advance(FRAME_S, ALONG_X);
      highest = Math.max(highest, walker.eyes[1] - before);
    }
    expect(walker.eyes[0]).toBeCloseTo(3, 1);
    expect(walker.eyes[1]).toBeCloseTo(EYES_M + 0.25, 3);
    expect(highest).toBeLessThan(0.1);
    // And down again without a fall.
    walked(walker, { ...STILL, way: [-1, 0] }, 1);
    expect(walker.eyes[1]).toBeCloseTo(EYES_M, 2);
  });

  it.each([0.35, 0.5, 3])('does not climb %s', (height) => {
    const walker = new Walker(ground(FLOOR, across(height)), START, EYES_M);
    walked(walker, { ...ALONG_X, isFast: true }, 2);
    expect(walker.eyes[0]).toBeLessThan(2);
    expect(walker.eyes[0]).toBeGreaterThan(1.7);
    expect(walker.eyes[1]).toBeCloseTo(EYES_M, 9);
  });

  it('slides along a wall, and stops in a corner', () => {
    const corner = [
      [-4, 0, 2],
      [4, 3, 2.5],
    ] as const;
    const walker = new Walker(ground(FLOOR, across(3), corner), START, EYES_M);
    const diagonal = { ...STILL, way: [Math.SQRT1_2, -Math.SQRT1_2] } as const;
    walked(walker, diagonal, 2);
    expect(walker.eyes[0]).toBeCloseTo(1.75, 2);
    // As fast as the way along it, but for a little friction.
    expect(walker.eyes[2] / (-2 * Math.SQRT2)).toBeCloseTo(1, 1);
    walked(walker, { ...diagonal, way: [Math.SQRT1_2, Math.SQRT1_2] }, 6);
    expect(walker.eyes[0]).toBeCloseTo(1.75, 2);
    expect(walker.eyes[2]).toBeCloseTo(1.75, 2);
  });

  it('does not pass a bar at the height of the chest', () => {
    const bar = [
      [2, 0.9, -4],
      [2.1, 1, 4],
    ] as const;
    const walker = new Walker(ground(FLOOR, bar), START, EYES_M);
    walked(walker, { ...ALONG_X, isFast: true }, 1);
    expect(walker.eyes[0]).toBeCloseTo(1.75, 2);
  });

  it('falls off a ledge as things fall, and lands', () => {
    const low = [
      [2, -5.25, -4],
      [20, -5, 4],
    ] as const;
    const walker = new Walker(
      ground(
        [
          [-4, -0.25, -4],
          [2, 0, 4],
        ],
        low,
      ),
      [1.9, 0, 0],
      EYES_M,
    );
    walked(walker, ALONG_X, 0.5);
    const falling = walker.eyes[1];
    expect(falling).toBeLessThan(EYES_M - 0.3);
    expect(falling).toBeGreaterThan(EYES_M - 0.5 * 9.81 * 0.5 ** 2);
    walked(walker, STILL, 1.5);
    expect(walker.eyes[1]).toBeCloseTo(EYES_M - 5, 6);
    expect(walker.isMoving).toBe(false);
  });

  it('is back where it last stood after a fall off the scene', () => {
    const walker = new Walker(ground(FLOOR), [3, 0, 0], EYES_M);
    expect(walked(walker, ALONG_X, 0.5)).toBe(false);
    expect(walked(walker, { ...ALONG_X, isFast: true }, 2)).toBe(true);
    walked(walker, STILL, 2);
    const [x, y] = walker.eyes;
    expect(x).toBeGreaterThan(3.9);
    expect(x).toBeLessThan(4.2);
    expect(y).toBeCloseTo(EYES_M, 6);
  });

  it('jumps half a metre high, and not through a ceiling', () => {
    const highest = (walker: Walker) => {
      let most = 0;
      for (let frame = 0; frame < 60; frame++) {
        walker.advance(FRAME_S, { ...STILL, isJumping: frame === 0 });
        most = Math.max(most, walker.eyes[1]);
      }
      expect(walker.eyes[1]).toBeCloseTo(EYES_M, 6);
      return most;
    };
    expect(highest(new Walker(ground(FLOOR), START, EYES_M))).toBeCloseTo(EYES_M + 0.5, 1);
    const ceiling = [
      [-4, 1.9, -4],
      [4, 2.1, 4],
    ] as const;
    expect(highest(new Walker(ground(FLOOR, ceiling), START, EYES_M))).toBeLessThan(1.9 - 0.1);
  });

  it('comes to the same place at any frame rate', () => {
    const scene = ground(FLOOR, across(0.25), [
      [3, 0, -1],
      [4, 3, 4],
    ]);
    const places = [1 / 240, 1 / 60, 1 / 7, 1].map((frameS) => {
      const walker = new Walker(scene, START, EYES_M);
      walked(walker, { ...ALONG_X, way: [0.8, 0.6] }, 2, frameS);
      return walker.eyes;
    });
    for (const place of places)
      for (const axis of [0, 1, 2]) expect(place[axis]).toBeCloseTo(places[0][axis], 2);
  });
});

describe('a place to stand', () => {
  it('is below the camera, beside walls, and nowhere without ground', () => {
    const scene = ground(FLOOR, across(3));
    expect(standingPlace(scene, [0, 2.5, 1], EYES_M)).toEqual([0, 0, 1]);
    const [x, y] = standingPlace(scene, [1.9, 2.5, 0], EYES_M)!;
    expect(x).toBeCloseTo(1.75, 2);
    expect(y).toBe(0);
    expect(standingPlace(scene, [0, -1, 0], EYES_M)).toBeNull();
    expect(standingPlace(scene, [9, 2, 0], EYES_M)).toBeNull();
  });
});

describe('the height of the eyes', () => {
  it.each([
    ['a room in metres', [6, 2.7, 5], 1.6],
    ['a street in metres', [60, 12, 30], 1.6],
    ['flat ground', [40, 0, 40], 1.6],
    ['a room in other units', [1.2, 0.54, 1], 0.351],
    ['a town', [1500, 80, 900], 10],
    ['a point', [0, 0, 0], 1.6],
  ] as const)('suits %s', (_name, size, height) => {
    expect(guessedEyeHeight(size, null)).toBeCloseTo(height, 3);
  });

  it('follows a length that is known', () => {
    expect(guessedEyeHeight([6, 2.7, 5], { perSceneUnit: 50, unit: 'cm' })).toBeCloseTo(3.2);
  });
});
