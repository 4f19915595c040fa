import { describe, expect, it } from 'vitest';
import { describeCost, formatCost } from './effect-costs.ts';

describe('the cost of an effect', () => {
  it.each([
    [{ median: 0.42, low: 0.38, high: 0.5 }, '0.42 ms', 'Costs 0.42 ms of each frame (0.38 to 0.50 ms).'],
    [{ median: -3, low: -4, high: -2 }, '−3.0 ms', 'Saves 3.0 ms of each frame (−4.0 to −2.0 ms).'],
    [
      { median: 0.2, low: -0.1, high: 1 },
      'under 1.0 ms',
      'Too small to measure: under 1.0 ms of each frame (−0.10 to 1.0 ms).',
    ],
  ])('is written for %o', (costMs, figure, sentence) => {
    expect(formatCost(costMs)).toBe(figure);
    expect(describeCost(costMs)).toBe(sentence);
  });
});
