import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../errors.ts';
import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type Accuracy,
  type AccuracyPreset,
  internAccuracy,
  maxColor,
  resolveAccuracy,
} from './accuracy.ts';

/** The argument that the error names, and the error's message. */
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
  test('presets resolve to themselves, and nothing to balanced', () => {
    for (const name of Object.keys(ACCURACY_PRESETS) as AccuracyPreset[])
      expect(resolveAccuracy(name)).toEqual(ACCURACY_PRESETS[name]);
    expect(resolveAccuracy()).toEqual(ACCURACY_PRESETS.balanced);
    expect(resolveAccuracy({})).toEqual(ACCURACY_PRESETS.balanced);
  });

  test('single settings change a preset', () => {
    expect(resolveAccuracy({ preset: 'high', sortKeyBits: 16 })).toEqual({
      ...ACCURACY_PRESETS.high,
      sortKeyBits: 16,
    });
    expect(resolveAccuracy({ alphaCutoff: 0.05 })).toEqual({
      ...ACCURACY_PRESETS.balanced,
      alphaCutoff: 0.05,
    });
  });

  test('every preset gives every setting a valid value', () => {
    for (const preset of Object.values(ACCURACY_PRESETS)) {
      expect(Object.keys(preset).sort()).toEqual(Object.keys(ACCURACY_SETTINGS).sort());
      expect(resolveAccuracy({ ...preset })).toEqual(preset);
    }
  });

  test('equal settings become the same object, however they are written', () => {
    const { balanced } = ACCURACY_PRESETS;
    expect(internAccuracy()).toBe(internAccuracy('balanced'));
    const reordered = Object.fromEntries(Object.entries(balanced).reverse());
    expect(internAccuracy(reordered)).toBe(internAccuracy());
    expect(internAccuracy({ sortKeyBits: 16 })).toBe(internAccuracy({ preset: 'balanced', sortKeyBits: 16 }));
    expect(internAccuracy({ sortKeyBits: 16 })).not.toBe(internAccuracy());
    const settings = internAccuracy({ preset: 'high', sortKeyBits: 24 });
    expect(internAccuracy(settings)).toBe(settings);
    expect(Object.isFrozen(settings)).toBe(true);
  });

  test('every setting has a label, a unit, a source, and a sentence about its effect', () => {
    for (const [name, { label, about, unit, source }] of Object.entries(ACCURACY_SETTINGS)) {
      for (const text of [label, unit, source]) expect(text, name).not.toBe('');
      expect(about, name).toMatch(/^[A-Z].*\.$/);
    }
  });

  test('colours end where record or target do', () => {
    expect(maxColor(ACCURACY_PRESETS.reference)).toBe(1e37);
    expect(maxColor(ACCURACY_PRESETS.balanced)).toBe(65504);
    expect(maxColor({ ...ACCURACY_PRESETS.reference, colorTarget: 'rgba8unorm' })).toBe(65504);
    expect(maxColor(ACCURACY_PRESETS.paper)).toBe(1);
  });

  test('unknown presets and settings are rejected by name, with the known ones', () => {
    expect(refusal('best')[1]).toMatch(/"best".*reference, high, balanced/);
    expect(refusal('toString')[0]).toBe('accuracy');
    expect(refusal({ preset: 'hasOwnProperty' })[0]).toBe('accuracy');
    expect(refusal({ sharpness: 3 })).toEqual(['sharpness', expect.stringContaining('sortKeyBits')]);
    expect(refusal({ constructor: 1 })[0]).toBe('constructor');
    for (const wrong of [3, null, true, [], () => 'high']) expect(refusal(wrong)[0]).toBe('accuracy');
  });

  test('invalid values are rejected, with the valid ones', () => {
    expect(refusal({ shPrecision: 'f64' })[0]).toBe('shPrecision');
    expect(refusal({ colorTarget: undefined })[0]).toBe('colorTarget');
    expect(refusal({ sortKeyBits: 20 })).toEqual(['sortKeyBits', expect.stringContaining('32, 24, 16')]);
    expect(refusal({ sortKeyBits: '16' })[0]).toBe('sortKeyBits');
    expect(refusal({ extent: 'none' })[0]).toBe('extent');
    expect(refusal({ culling: true })[0]).toBe('culling');
    for (const resolutionScale of [0, 0.2, 1.01, Number.NaN])
      expect(refusal({ resolutionScale })).toEqual(['resolutionScale', expect.stringContaining('0.25…1')]);
    for (const alphaCutoff of [0, -1, 0.2, Number.NaN, '0.01', null])
      expect(refusal({ alphaCutoff })[0]).toBe('alphaCutoff');
  });
});
