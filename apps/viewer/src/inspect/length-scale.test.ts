import { describe, expect, it } from 'vitest';
import { formatFigure, formatLength, lengthScaleKey, readLengthScale, scaleFrom } from './length-scale.ts';

describe('a known length', () => {
  it('gives the scale of the scene, in which the ruler has that length', () => {
    const scale = scaleFrom(2.5, 5, 'm');
    expect(scale).toEqual({ perSceneUnit: 2, unit: 'm' });
    expect(formatLength(2.5, scale)).toBe('5 m');
  });

  it.each([
    [0, 1],
    [1, 0],
    [1, -2],
    [1, Number.NaN],
    [1, Number.POSITIVE_INFINITY],
  ])('cannot be %d units that are %d', (distance, length) => {
    expect(scaleFrom(distance, length, 'cm')).toBeNull();
  });

  it('is kept with the scene; anything else that is kept there is no scale', () => {
    expect(lengthScaleKey('a')).not.toBe(lengthScaleKey('b'));
    expect(readLengthScale('{"perSceneUnit":0.5,"unit":"ft"}')).toEqual({ perSceneUnit: 0.5, unit: 'ft' });
    for (const text of [
      null,
      '',
      '{',
      'null',
      '{"perSceneUnit":1}',
      '{"perSceneUnit":-1,"unit":"m"}',
      '{"perSceneUnit":1,"unit":"league"}',
    ])
      expect(readLengthScale(text)).toBeNull();
  });
});

it.each([
  [1.23456789, '1.2346'],
  [-12.5, '−12.5'],
  [0, '0'],
  [0.00012345678, '0.00012346'],
  [0.0000123, '1.2300 × 10⁻⁵'],
  [-3e9, '−3.0000 × 10⁹'],
  [Number.POSITIVE_INFINITY, '∞'],
  [Number.NEGATIVE_INFINITY, '−∞'],
  [Number.NaN, '–'],
])('%d is written %s', (value, text) => {
  expect(formatFigure(value)).toBe(text);
});

it('without a scale lengths are in scene units', () => {
  expect(formatLength(0.123456, null)).toBe('0.1235 units');
});
