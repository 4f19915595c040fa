import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { expectInvalid } from '../../testing/edited-splats.ts';
import { FakeCanvas } from '../../testing/fake-canvas.ts';
import { colorOf } from '../splats/color-values.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { splatsFromText, type TextSplatsOptions } from './splats-from-text.ts';

beforeEach(() => void vi.stubGlobal('OffscreenCanvas', FakeCanvas));
afterEach(() => void vi.unstubAllGlobals());

/** Extents of the centres along x and y. */
function extentsOf({ count, positions, origin }: SplatSet) {
  return [0, 1].map((axis) => {
    const values = Array.from({ length: count }, (_, i) => positions[3 * i + axis] + origin[axis]);
    return [Math.min(...values), Math.max(...values)];
  });
}

describe('splats from text', () => {
  test('are one for each pixel of the letters, in their colour, with a font 1 unit high', () => {
    const set = splatsFromText('ab', { sizePx: 8, color: 'orange' });
    // A letter of the fake canvas has 4 × 6 pixels.
    expect(set.count).toBe(48);
    expect(colorOf(set.colorDc[1])).toBeCloseTo(165 / 255, 6);
    const [[left, right], [bottom, top]] = extentsOf(set);
    expect([left, right].map((x) => 8 * x)).toEqual([-3.5, 3.5]);
    expect([bottom, top].map((y) => 8 * y)).toEqual([-2.5, 2.5]);
  });

  test('take the options of images', () => {
    const set = splatsFromText('ab', { sizePx: 8, pixelSize: 2, stepPx: 2, spread: 1 });
    const [[left, right]] = extentsOf(set);
    expect(right - left).toBeGreaterThanOrEqual(12);
    expect(Math.exp(set.logScales[0])).toBeCloseTo(4, 5);
  });

  test('have lines, placed beside each other, around the middle of the letters', () => {
    const lefts = (align: TextSplatsOptions['align']) => {
      const set = splatsFromText('abcd\n\na', { sizePx: 8, lineHeight: 1.5, align, pixelSize: 1 });
      expect(set.count).toBe(5 * 24);
      const [xs, ys] = extentsOf(set);
      expect(xs).toEqual([-7.5, 7.5]);
      // Two lines further down, 12 pixels each.
      expect(ys[1] - ys[0]).toBe(24 + 5);
      return set.positions[3 * 96] + set.origin[0];
    };
    expect([lefts('left'), lefts('center'), lefts('right')]).toEqual([-7.5, -1.5, 4.5]);
  });

  test('are refused by name', () => {
    for (const text of ['', '  ', '\n\n', 5, null])
      expectInvalid('text', () => splatsFromText(text as string));
    expectInvalid('text', () => splatsFromText('a'.repeat(1000)));
    expectInvalid('text', () => splatsFromText('abc\ndef', { sizePx: 4096 }));
    expectInvalid('text', () => splatsFromText('a\n'.repeat(200_000)));
    expectInvalid('options', () => splatsFromText('a', null as never));
    for (const sizePx of [0, Number.NaN, -1, 1e300])
      expectInvalid('sizePx', () => splatsFromText('a', { sizePx }));
    expectInvalid('lineHeight', () => splatsFromText('a', { lineHeight: 0 }));
    expectInvalid('align', () => splatsFromText('a', { align: 'justify' as 'left' }));
    expectInvalid('font', () => splatsFromText('a', { font: '{}' }));
    expectInvalid('color', () => splatsFromText('a', { color: 'colour' }));
    expectInvalid('spread', () => splatsFromText('a', { spread: -1 }));
  });

  test('are refused without a canvas', () => {
    vi.unstubAllGlobals();
    expect(() => splatsFromText('a')).toThrow(expect.objectContaining({ code: 'canvas-unavailable' }));
  });
});
