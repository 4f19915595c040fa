import { describe, expect, it } from 'vitest';
import { DoubleTap } from './orbit-controls.ts';

const at = (timeStamp: number, clientX = 0, pointerId = 1) => ({ timeStamp, clientX, clientY: 0, pointerId });

/** Taps where and when it is said; returns whether that was a double tap. */
function tap(taps: DoubleTap, timeMs: number, xPx = 0): boolean {
  taps.pointerDown(at(timeMs, xPx), true);
  return taps.pointerUp(at(timeMs + 50, xPx));
}

describe('a double tap', () => {
  it('is two taps soon after each other, and not three', () => {
    const taps = new DoubleTap();
    expect([tap(taps, 0), tap(taps, 200), tap(taps, 400), tap(taps, 600)]).toEqual([
      false,
      true,
      false,
      true,
    ]);
  });

  it('is none where the taps are apart in time or place', () => {
    const taps = new DoubleTap();
    expect([tap(taps, 0), tap(taps, 1000), tap(taps, 1200, 40)]).toEqual([false, false, false]);
  });

  it('is none where a drag, another finger or another button comes between', () => {
    const taps = new DoubleTap();
    tap(taps, 0);
    taps.pointerDown(at(100), true);
    expect(taps.pointerUp(at(150, 20))).toBe(false);
    expect(tap(taps, 200)).toBe(false);
    taps.pointerDown(at(300), true);
    taps.pointerDown(at(310, 0, 2), false);
    expect(taps.pointerUp(at(350))).toBe(false);
    expect(taps.pointerUp(at(360, 0, 2))).toBe(false);
  });
});
