import { describe, expect, it } from 'vitest';
import { SHEET_PARTS, settledSheet, sheetText, steppedSheet, toggledSheet } from './sheet-grip.tsx';

const [LOW, HALF, FULL] = SHEET_PARTS;

describe('a sheet', () => {
  it('comes to rest at the nearest height where it is let go', () => {
    expect(settledSheet(0.35, 0)).toBe(LOW);
    expect(settledSheet(0.45, 0)).toBe(HALF);
    expect(settledSheet(2, 0)).toBe(FULL);
  });

  it('goes on in the direction in which it is thrown', () => {
    expect(settledSheet(0.45, 3)).toBe(FULL);
    expect(settledSheet(0.55, -1.5)).toBe(LOW);
  });

  it('closes where it is let go near the edge, or thrown there', () => {
    expect(settledSheet(0.15, 0)).toBeNull();
    expect(settledSheet(0.3, -2)).toBeNull();
  });

  it('is moved by the keys of a slider, and not past its ends', () => {
    expect(steppedSheet(HALF, 'ArrowUp')).toBe(FULL);
    expect(steppedSheet(FULL, 'ArrowUp')).toBe(FULL);
    expect(steppedSheet(HALF, 'ArrowDown')).toBe(LOW);
    expect(steppedSheet(HALF, 'Home')).toBe(LOW);
    expect(steppedSheet(HALF, 'End')).toBe(FULL);
    expect(steppedSheet(HALF, 'a')).toBeNull();
  });

  it('goes up by taps, and from the top to its lowest height', () => {
    expect(toggledSheet(LOW)).toBe(HALF);
    expect(toggledSheet(FULL)).toBe(LOW);
  });

  it('is told in words', () => {
    expect(sheetText(0.31)).toBe('low');
    expect(sheetText(1)).toBe('full');
  });
});
