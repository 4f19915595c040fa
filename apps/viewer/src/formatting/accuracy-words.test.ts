import { ACCURACY_PRESETS, resolveAccuracy } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import {
  describeAccuracy,
  describeMeasured,
  formatValue,
  inPlainWords,
  nearestPreset,
  PRESET_NAMES,
  valueWords,
} from './accuracy-words.ts';

describe('accuracy in words', () => {
  it.each(PRESET_NAMES)('knows the preset %s again', (preset) => {
    expect(nearestPreset({ ...ACCURACY_PRESETS[preset] })).toEqual({ preset, changed: [] });
  });

  it('names what differs from the nearest preset', () => {
    const settings = resolveAccuracy({ preset: 'high', shDegree: 1 });
    expect(nearestPreset(settings)).toEqual({ preset: 'high', changed: ['shDegree'] });
    expect(describeAccuracy(settings)).toMatch(/^high, .* 1$/);
  });

  it.each([
    [1 / 255, '1/255'],
    [0.0123456, '0.0123'],
    [0.5, '0.5'],
    [24, '24'],
    ['f16', 'f16'],
  ] as const)('writes the value %s as %s', (value, text) => expect(formatValue(value as 3)).toBe(text));

  it.each([
    ['sortKeyBits', 16, '16 bits'],
    ['shDegree', 2, '2'],
    ['alphaCutoff', 1 / 128, '1/128'],
    ['geometryPrecision', 'f32', '32-bit floats'],
    ['culling', 'frustum', 'by chunk only'],
    ['rasterizer', 'tiles', 'tiles'],
  ] as const)('calls the value of %s, %s, “%s”', (name, value, words) => {
    expect(valueWords(name, value)).toBe(words);
  });

  it('calls what was measured by plain names', () => {
    const fast = ACCURACY_PRESETS.fast;
    expect(describeMeasured({ name: 'fast', settings: fast, changed: ['sortKeyBits'] })).toBe('fast');
    const changed = ['shDegree', 'sortKeyBits'] as const;
    const settings = resolveAccuracy({ shDegree: 1, sortKeyBits: 20 });
    expect(describeMeasured({ name: 'shDegree 1, sortKeyBits 20', settings, changed })).toBe(
      'Harmonics degree 1, Sort keys 20 bits',
    );
    expect(
      inPlainWords('“shDegree 1” is the fastest.', { name: 'shDegree 1', settings, changed: ['shDegree'] }),
    ).toBe('“Harmonics degree 1” is the fastest.');
    const ablation = resolveAccuracy({ preset: 'paper', culling: 'frustum' });
    expect(describeMeasured({ name: 'paper −CULL', settings: ablation, changed: ['culling'] })).toBe(
      'paper, Culling by chunk only',
    );
    expect(describeMeasured({ name: 'base', settings: ablation, changed: [] })).toContain('paper');
  });
});
