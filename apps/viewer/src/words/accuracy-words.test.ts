import { ACCURACY_PRESETS, resolveAccuracy } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { describeAccuracy, formatValue, nearestPreset, PRESET_NAMES } from './accuracy-words.ts';

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
});
