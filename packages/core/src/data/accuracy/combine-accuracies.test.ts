import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../errors.ts';
import { ACCURACY_PRESETS, ACCURACY_SETTINGS } from './accuracy.ts';
import { combineAccuracies, mostExact } from './combine-accuracies.ts';

describe('the accuracy of a frame', () => {
  test('is undefined if no cloud requests any, and the request of the only cloud that does', () => {
    expect(combineAccuracies([])).toBeUndefined();
    for (const only of ['fast', { preset: 'high', sortKeyBits: 24 }] as const)
      expect(combineAccuracies([only])).toBe(only);
    for (const target of [{ minPsnrDb: 45 }, { maxFrameMs: 8 }])
      expect(combineAccuracies([target])).toBe(target);
  });

  test('has each setting at the most exact requested value', () => {
    expect(combineAccuracies(['fast', 'paper'])).toEqual({
      ...ACCURACY_PRESETS.fast,
      geometryPrecision: 'f32',
      shPrecision: 'f32',
      sortKeyBits: 32,
      alphaCutoff: 1 / 255,
    });
    const finer = { resolutionScale: 0.75, sortKeyBits: 16 } as const;
    expect(combineAccuracies([{ resolutionScale: 0.5 }, finer])).toEqual({
      ...ACCURACY_PRESETS.balanced,
      resolutionScale: 0.75,
    });
  });

  test('prefers a target for an error to settings, and settings to a target for a time', () => {
    const targets = [{ maxFrameMs: 8 }, { minPsnrDb: 45 }, { maxFrameMs: 4 }, { minPsnrDb: 50 }];
    expect(combineAccuracies(['reference', ...targets])).toEqual({ minPsnrDb: 50 });
    expect(combineAccuracies([targets[0], 'fast', targets[2]])).toBe('fast');
    expect(combineAccuracies([targets[0], targets[2]])).toEqual({ maxFrameMs: 4 });
  });

  test('is rejected if a setting is unknown', () => {
    expect(() => combineAccuracies(['balanced', 'perfect' as never])).toThrow(InvalidArgumentError);
  });
});

test('the most exact combination of presets is at least as exact as each in every setting, in any order', () => {
  const presets = Object.values(ACCURACY_PRESETS);
  const found = mostExact(presets);
  expect(mostExact(presets.toReversed())).toEqual(found);
  for (const [name, { values }] of Object.entries(ACCURACY_SETTINGS)) {
    if ('min' in values) continue;
    const rank = (settings: object) => (values as unknown[]).indexOf(settings[name as never]);
    for (const preset of presets) expect(rank(found), name).toBeLessThanOrEqual(rank(preset));
  }
});
