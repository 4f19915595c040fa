import { describe, expect, test } from 'vitest';
import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type Accuracy,
  type AccuracyPreset,
  resolveAccuracy,
} from './accuracy.ts';
import { InvalidArgumentError } from './errors.ts';

/** The argument that the error names, and what it says. */
function refusal(accuracy: unknown): [argument: string, message: string] {
  try {
    resolveAccuracy(accuracy as Accuracy);
  } catch (error) {
    expect(error).toBeInstanceOf(InvalidArgumentError);
    const { argument, message } = error as InvalidArgumentError;
    return [argument, message];
  }
  throw new Error(`${JSON.stringify(accuracy)} was not refused.`);
}

describe('accuracy', () => {
  test('presets stand for themselves, nothing for balanced', () => {
    for (const name of Object.keys(ACCURACY_PRESETS) as AccuracyPreset[])
      expect(resolveAccuracy(name)).toEqual(ACCURACY_PRESETS[name]);
    expect(resolveAccuracy()).toEqual(ACCURACY_PRESETS.balanced);
    expect(resolveAccuracy({})).toEqual(ACCURACY_PRESETS.balanced);
  });

  test('single settings change a preset', () => {
    expect(resolveAccuracy({ preset: 'high', shDegree: 1 })).toEqual({
      ...ACCURACY_PRESETS.high,
      shDegree: 1,
    });
    expect(resolveAccuracy({ alphaCutoff: 0.05 })).toEqual({
      ...ACCURACY_PRESETS.balanced,
      alphaCutoff: 0.05,
    });
  });

  test('every preset gives every setting a value that may stand there', () => {
    for (const preset of Object.values(ACCURACY_PRESETS)) {
      expect(Object.keys(preset).sort()).toEqual(Object.keys(ACCURACY_SETTINGS).sort());
      expect(resolveAccuracy({ ...preset })).toEqual(preset);
    }
  });

  test('unknown presets and settings are refused by name, with what there is', () => {
    expect(refusal('best')[1]).toMatch(/"best".*reference, high, balanced/);
    expect(refusal('toString')[0]).toBe('accuracy');
    expect(refusal({ preset: 'hasOwnProperty' })[0]).toBe('accuracy');
    expect(refusal({ sharpness: 3 })).toEqual(['sharpness', expect.stringContaining('shDegree')]);
    expect(refusal({ constructor: 1 })[0]).toBe('constructor');
  });

  test('values that may not stand there are refused, with those that may', () => {
    expect(refusal({ shDegree: 4 })).toEqual(['shDegree', expect.stringMatching(/4.*3, 2, 1, 0/)]);
    expect(refusal({ shPrecision: 'f64' })[0]).toBe('shPrecision');
    expect(refusal({ colorTarget: undefined })[0]).toBe('colorTarget');
    for (const alphaCutoff of [0, -1, 0.2, Number.NaN, '0.01', null])
      expect(refusal({ alphaCutoff })[0]).toBe('alphaCutoff');
  });
});
