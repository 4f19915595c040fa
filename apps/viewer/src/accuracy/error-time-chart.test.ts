import { describe, expect, it } from 'vitest';
import { ticksIn } from './error-time-chart.tsx';

const textsIn = (from: number, to: number, most: number) => ticksIn([from, to], most).map(({ text }) => text);

describe('ticks of an axis', () => {
  it('are round values at steps of 1, 2 or 5, lowest first', () => {
    expect(textsIn(3, 11, 8)).toEqual(['3', '4', '5', '6', '7', '8', '9', '10', '11']);
    expect(textsIn(3, 11, 4)).toEqual(['4', '6', '8', '10']);
    expect(textsIn(18, 57, 9)).toEqual(['20', '25', '30', '35', '40', '45', '50', '55']);
    expect(textsIn(0, 7, 1)).toEqual(['0']);
    expect(textsIn(80, 1150, 3)).toEqual(['500', '1000']);
  });

  it('have as many decimals as the step needs', () => {
    expect(textsIn(0.02, 0.31, 3)).toEqual(['0.1', '0.2', '0.3']);
    expect(textsIn(0.91, 1.02, 6)).toEqual(['0.92', '0.94', '0.96', '0.98', '1.00', '1.02']);
    expect(textsIn(0, 0.0009, 1)).toEqual(['0.000']);
  });

  it('lie within the range, no more than were asked for and one', () => {
    for (const [from, to] of [
      [0, 1],
      [0.07, 0.0701],
      [99.9, 1200],
      [1e-6, 3e-6],
    ] as const) {
      for (let most = 1; most < 12; most++) {
        const values = ticksIn([from, to], most).map(({ value }) => value);
        expect(values.length).toBeLessThanOrEqual(most + 1);
        for (const value of values)
          expect(value >= from * (1 - 1e-12) && value <= to * (1 + 1e-12)).toBe(true);
      }
    }
  });
});
