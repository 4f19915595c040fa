import { describe, expect, it } from 'vitest';
import { movedSplit, splitText } from './compared-pictures.tsx';

describe('line of a split image', () => {
  it.each([
    ['ArrowLeft', false, 0.49],
    ['ArrowRight', false, 0.51],
    ['ArrowRight', true, 0.6],
    ['PageDown', false, 0.4],
    ['Home', false, 0],
    ['End', false, 1],
    ['x', false, null],
    ['toString', false, null],
  ] as const)('goes by %s (Shift: %s) to %s', (key, isShift, part) =>
    expect(movedSplit(0.5, key, isShift)).toBe(part),
  );

  it('stays in the image, and comes back where it was', () => {
    expect(movedSplit(0.003, 'ArrowLeft', false)).toBe(0);
    expect(movedSplit(0.98, 'PageUp', false)).toBe(1);
    let part = 0.5;
    for (const key of ['ArrowLeft', 'ArrowRight']) {
      for (let i = 0; i < 30; i++) part = movedSplit(part, key, false) ?? part;
    }
    expect(part).toBe(0.5);
  });

  it('says how much of each side is seen', () => {
    expect(splitText(0.305, 'fast', 'reference')).toBe('31 % fast, 69 % reference');
  });
});
