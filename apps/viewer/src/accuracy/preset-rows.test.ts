import { describe, expect, test } from 'vitest';
import { PRESET_NAMES } from '../state/accuracy.ts';
import {
  barParts,
  beyondLabel,
  errorLabel,
  type PresetCost,
  recommendedOf,
  verdictOf,
} from './preset-rows.tsx';

function cost(name: string, ms: number, maxSteps: number, spreadMs = 0, p999Steps = maxSteps): PresetCost {
  const totalMs = { median: ms, low: ms - spreadMs, high: ms + spreadMs };
  return { name, totalMs, stagesMs: null, maxSteps, p999Steps };
}

/** All presets: these, and the others much slower than any. */
function allOf(...costs: readonly PresetCost[]): PresetCost[] {
  const others = PRESET_NAMES.filter((name) => costs.every((each) => each.name !== name));
  return [...costs, ...others.map((name) => cost(name, 1000, 40))];
}

describe('verdictOf', () => {
  const reference = cost('reference', 5, 0, 0.1);
  const balanced = cost('balanced', 4.2, 1.2, 0.1);
  const fast = cost('fast', 3, 103, 0.1);

  test('names the quickest preset that cannot be told from the reference, and the quickest', () => {
    const high = cost('high', 4.5, 0.9, 0.1);
    expect(verdictOf(allOf(reference, high, balanced, fast))).toBe(
      'The exact picture costs 5.0 ms per frame instead of 4.2 with balanced, ' +
        'where no pixel is off by more than 1 of 255. ' +
        'fast takes 3.0 ms, but there a pixel is off by up to 103 of 255.',
    );
    expect(verdictOf(allOf(reference, high, balanced))).toBe(
      'The exact picture costs 5.0 ms per frame instead of 4.2 with balanced, ' +
        'where no pixel is off by more than 1 of 255.',
    );
    expect(verdictOf(allOf(reference, fast))).toBe(
      'The exact picture costs 5.0 ms per frame instead of 3.0 with fast, ' +
        'where a pixel is off by up to 103 of 255.',
    );
  });

  test('names a preset whose errors are rare and faint, but none with one that stands out', () => {
    const faint = cost('balanced', 3.3, 6, 0.1, 0.9);
    const all = allOf(reference, faint, fast);
    expect(verdictOf(all)).toBe(
      'The exact picture costs 5.0 ms per frame instead of 3.3 with balanced, ' +
        'where 99.9 % of the colours are within 1 of 255, and the worst is off by 6. ' +
        'fast takes 3.0 ms, but there a pixel is off by up to 103 of 255.',
    );
    expect(recommendedOf(all)).toBe('balanced');
    expect(recommendedOf(allOf(reference, { ...faint, maxSteps: 9 }, fast))).toBe('reference');
    expect(recommendedOf(allOf(reference, { ...faint, p999Steps: 2 }, fast))).toBe('reference');
  });

  test('takes times that cannot be told apart for the same', () => {
    const alike = PRESET_NAMES.map((name) => cost(name, name === 'reference' ? 5 : 4.8, 103, 0.5));
    expect(verdictOf(alike)).toBe(
      'The exact picture costs nothing more here: all presets take about the same.',
    );
    expect(verdictOf(allOf(cost('reference', 5, 0, 3), cost('fast', 3, 103, 0.5)))).toBe(
      'Times vary too much here to tell what the exact picture costs. Measure again when the device is idle.',
    );
    // As a busy machine measured: the interval of balanced has all of the reference's in it.
    const busy = allOf(
      cost('reference', 1650, 0, 60),
      cost('high', 2120, 2, 250),
      cost('balanced', 1958, 2, 740),
      cost('fast', 2941, 61, 900),
      cost('paper', 2264, 131, 400),
    );
    expect(verdictOf(busy)).toContain('vary too much');
    expect(verdictOf(allOf(reference))).toBe(
      'The exact picture costs nothing more here: no preset is quicker than reference.',
    );
  });

  test('says nothing before all are measured, because each may turn it around', () => {
    const all = allOf(reference, balanced, fast);
    for (let count = 0; count < all.length; count++) {
      expect(verdictOf(all.slice(0, count)), `${count}`).toBeNull();
      expect(recommendedOf(all.slice(0, count)), `${count}`).toBeNull();
    }
  });

  test('recommends what is quicker without a visible error, or the reference', () => {
    expect(recommendedOf(allOf(reference, balanced, fast))).toBe('balanced');
    expect(recommendedOf(allOf(reference, fast))).toBe('reference');
    const unsure = { ...balanced, totalMs: { median: 4.2, low: 3, high: 6 } };
    expect(recommendedOf(allOf(reference, unsure))).toBeNull();
    expect(recommendedOf(allOf(reference))).toBe('reference');
  });
});

describe('bars', () => {
  const lengthOf = (each: Parameters<typeof barParts>[0]) =>
    barParts(each).reduce((sum, { ms }) => sum + ms, 0);

  test('are as long as the total, whatever the medians of stages add up to', () => {
    for (const stagesMs of [[400, 300, 900], [1, 2, 3], null, [0, 0, 0]])
      expect(lengthOf({ totalMs: { median: 1493, low: 0, high: 0 }, stagesMs })).toBeCloseTo(1493, 9);
    expect(barParts({ totalMs: { median: 6, low: 6, high: 6 }, stagesMs: [1, 0, 1] })).toEqual([
      { stage: 'preprocess', ms: 3 },
      { stage: 'sort', ms: 0 },
      { stage: 'rasterize', ms: 3 },
    ]);
  });

  test('have no parts without a time', () => {
    expect(barParts({ totalMs: { median: 0, low: 0, high: 0 }, stagesMs: null })).toEqual([]);
  });
});

test('shares of pixels are told beside the largest error', () => {
  expect(beyondLabel({ beyond1: 0.0312, beyond8: 0 })).toBe('3.1\u00a0% of pixels above 1');
  expect(beyondLabel({ beyond1: 0.0312, beyond8: 0.0002 })).toBe(
    '3.1\u00a0% of pixels above 1, <\u00a00.1\u00a0% above 8',
  );
});

test('errors are rounded to steps of 8 bits', () => {
  expect([0.2, 0.6, 103.4].map(errorLabel)).toEqual([
    'identical',
    'largest error 1 of 255',
    'largest error 103 of 255',
  ]);
});
