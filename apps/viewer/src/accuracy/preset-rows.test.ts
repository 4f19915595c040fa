import { describe, expect, test } from 'vitest';
import { errorLabel, type PresetCost, verdictOf } from './preset-rows.tsx';

function cost(name: string, ms: number, maxSteps: number, spreadMs = 0): PresetCost {
  const totalMs = { median: ms, low: ms - spreadMs, high: ms + spreadMs };
  return { name, totalMs, stagesMs: null, maxSteps };
}

describe('verdictOf', () => {
  test('names the quickest preset that cannot be told from the reference, and the quickest', () => {
    const costs = [
      cost('reference', 5, 0, 0.1),
      cost('high', 4.5, 0.9, 0.1),
      cost('balanced', 4.2, 1.2, 0.1),
      cost('fast', 3, 103, 0.1),
    ];
    expect(verdictOf(costs)).toBe(
      'balanced is 16 % quicker than reference: no pixel is off by more than 1 of 255. ' +
        'fast is 40 % quicker: a pixel is off by up to 103 of 255.',
    );
    expect(verdictOf(costs.slice(0, 3))).toBe(
      'balanced is 16 % quicker than reference: no pixel is off by more than 1 of 255.',
    );
    expect(verdictOf([costs[0], costs[3]])).toBe(
      'fast is 40 % quicker than reference: a pixel is off by up to 103 of 255.',
    );
  });

  test('takes times that cannot be told apart for the same', () => {
    expect(verdictOf([cost('reference', 5, 0, 0.5), cost('fast', 4.8, 103, 0.5)])).toBe(
      'All presets take about the same here: the exact picture of reference costs nothing more.',
    );
    expect(verdictOf([cost('reference', 5, 0, 3), cost('fast', 3, 103, 0.5)])).toBe(
      'Times vary too much here to tell whether any preset is quicker than reference.',
    );
    expect(verdictOf([cost('reference', 5, 0), cost('paper', 130, 40)])).toBe(
      'No preset is quicker here: the exact picture of reference costs nothing more.',
    );
  });

  test('says nothing without the reference, or of it alone', () => {
    expect(verdictOf([cost('fast', 3, 103)])).toBeNull();
    expect(verdictOf([cost('reference', 3, 0)])).toBeNull();
  });
});

test('errors are rounded to steps of 8 bits', () => {
  expect([0.2, 0.6, 103.4].map(errorLabel)).toEqual([
    'identical',
    'largest error 1 of 255',
    'largest error 103 of 255',
  ]);
});
