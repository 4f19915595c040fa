import { ACCURACY_PRESETS, resolveAccuracy } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import {
  addressWithAccuracy,
  decodeAccuracy,
  describeAccuracy,
  describeWish,
  encodeAccuracy,
  formatValue,
  nearestPreset,
  PRESET_NAMES,
  positionOf,
  SLIDER_STEPS,
  valueAt,
} from './accuracy-text.ts';

const address = (text: string) => new URL(text, 'http://localhost/');

describe('accuracy as text', () => {
  it.each(PRESET_NAMES)('knows the preset %s again', (preset) => {
    expect(nearestPreset({ ...ACCURACY_PRESETS[preset] })).toEqual({ preset, changed: [] });
  });

  it('names what differs from the nearest preset', () => {
    const settings = resolveAccuracy({ preset: 'high', shDegree: 1 });
    expect(nearestPreset(settings)).toEqual({ preset: 'high', changed: ['shDegree'] });
    expect(describeAccuracy(settings)).toMatch(/^high, .* 1$/);
  });

  it.each([
    ['fast', 'fast'],
    ['balanced', null],
    [{ preset: 'high', alphaCutoff: 0.02 }, 'high,alphaCutoff:0.02'],
    [{ shDegree: 1, shPrecision: 'u8' }, 'balanced,shDegree:1'],
  ] as const)('writes %o as %s and reads it back', (accuracy, text) => {
    const settings = resolveAccuracy(accuracy);
    expect(encodeAccuracy(settings)).toBe(text);
    expect(decodeAccuracy(text)).toEqual(settings);
  });

  it.each([
    [{ minPsnrDb: 45 }, 'minPsnrDb:45', 'at least 45 dB'],
    [{ maxFrameMs: 0.5 }, 'maxFrameMs:0.5', 'at most 0.5 ms'],
  ])('writes the wish %o as %s, and for people', (wish, text, words) => {
    expect(encodeAccuracy(wish)).toBe(text);
    expect(decodeAccuracy(text)).toEqual(wish);
    expect(describeWish(wish)).toBe(words);
  });

  it('takes changes of the default without its name', () => {
    expect(decodeAccuracy('shDegree:0')).toMatchObject({ shDegree: 0 });
  });

  it.each(['best', 'fast,nonsense:1', 'fast,shDegree:9', 'fast,shDegree', 'fast,shDegree:', ''])(
    'refuses %j with what would do',
    (text) => expect(() => decodeAccuracy(text)).toThrow(/there are|must be|must lie/),
  );

  it.each(['minPsnrDb:0', 'minPsnrDb:', 'maxFrameMs:soon', 'fast,minPsnrDb:45'])(
    'refuses the wish %j with what would do',
    (text) => expect(() => decodeAccuracy(text)).toThrow(/write minPsnrDb|there are/),
  );

  it('keeps the rest of the address, and is silent about the default', () => {
    const shared = addressWithAccuracy(
      address('/x/?scene=hard:a,b#top'),
      resolveAccuracy({ preset: 'high', shDegree: 0 }),
    );
    expect(shared).toBe('/x/?scene=hard:a,b&accuracy=high,shDegree:0#top');
    expect(addressWithAccuracy(address(shared), resolveAccuracy('balanced'))).toBe('/x/?scene=hard:a,b#top');
    expect(addressWithAccuracy(address('/?accuracy=fast'), resolveAccuracy())).toBe('/');
  });

  it.each([
    [1 / 255, '1/255'],
    [0.0123456, '0.0123'],
    [0.5, '0.5'],
    [24, '24'],
    ['f16', 'f16'],
  ] as const)('writes the value %s as %s', (value, text) => expect(formatValue(value as 3)).toBe(text));

  it.each([
    [1 / 4096, 0.1],
    [0.25, 1],
  ])('moves a slider through %d…%d and back', (min, max) => {
    const range = { min, max };
    expect(valueAt(0, range)).toBe(min);
    expect(valueAt(SLIDER_STEPS, range)).toBe(max);
    for (let position = 0; position < SLIDER_STEPS; position++) {
      expect(positionOf(valueAt(position, range), range)).toBe(position);
      expect(valueAt(position + 1, range)).toBeGreaterThan(valueAt(position, range));
    }
  });
});
