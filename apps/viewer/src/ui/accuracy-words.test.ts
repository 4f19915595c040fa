import { ACCURACY_PRESETS, resolveAccuracy } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { nearestPreset, PRESET_NAMES } from '../state/accuracy.ts';
import {
  describeAccuracy,
  describeMeasured,
  formatValue,
  inPlainWords,
  valueWords,
} from './accuracy-words.ts';

describe('accuracy in words', () => {
  it.each(PRESET_NAMES)('knows the preset %s again', (preset) => {
    expect(nearestPreset({ ...ACCURACY_PRESETS[preset] })).toEqual({ preset, changed: [] });
  });

  it('names what differs from the nearest preset', () => {
    const settings = resolveAccuracy({ preset: 'high', sortKeyBits: 16 });
    expect(nearestPreset(settings)).toEqual({ preset: 'high', changed: ['sortKeyBits'] });
    expect(describeAccuracy(settings)).toMatch(/^high, 16-bit sort keys$/);
  });

  it.each([
    [1 / 255, '1/255'],
    [0.0123456, '0.0123'],
    [0.5, '0.5'],
    [24, '24'],
    ['f16', 'f16'],
  ] as const)('writes the value %s as %s', (value, text) => expect(formatValue(value as 3)).toBe(text));

  it.each([
    ['sortKeyBits', 16, '16-bit'],
    ['resolutionScale', 0.5, '0.5'],
    ['alphaCutoff', 1 / 128, '1/128'],
    ['geometryPrecision', 'f32', '32-bit'],
    ['culling', 'frustum', 'by chunk only'],
    ['rasterizer', 'tiles', 'tiles'],
  ] as const)('calls the value of %s, %s, “%s”', (name, value, words) => {
    expect(valueWords(name, value)).toBe(words);
  });

  it('calls what was measured by plain names', () => {
    const fast = ACCURACY_PRESETS.fast;
    expect(describeMeasured({ name: 'fast', settings: fast, changed: ['sortKeyBits'] })).toBe('fast');
    const changed = ['sortKeyBits', 'culling'] as const;
    const settings = resolveAccuracy({ sortKeyBits: 16, culling: 'frustum' });
    expect(describeMeasured({ name: 'sortKeyBits 16, culling frustum', settings, changed })).toBe(
      '16-bit sort keys, culling by chunk only',
    );
    expect(
      inPlainWords('“sortKeyBits 16” is the fastest.', {
        name: 'sortKeyBits 16',
        settings,
        changed: ['sortKeyBits'],
      }),
    ).toBe('“16-bit sort keys” is the fastest.');
    const ablation = resolveAccuracy({ preset: 'paper', culling: 'frustum' });
    expect(describeMeasured({ name: 'paper −CULL', settings: ablation, changed: ['culling'] })).toBe(
      'paper, culling by chunk only',
    );
    expect(describeMeasured({ name: 'base', settings: ablation, changed: [] })).toContain('paper');
  });
});
