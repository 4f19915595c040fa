import { describe, expect, test } from 'vitest';
import { reference } from '../../gpu/effects/grade/grade.reference.ts';
import { grade } from '../../gpu/effects/grade/grade.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { InvalidArgumentError } from '../errors.ts';
import type { gradeMatrix } from '../math/grade-matrix.ts';
import { colorOf } from '../splats/color-values.ts';
import { gradeSplats } from './grade-splats.ts';

const OPTIONS = { exposure: 0.7, saturation: 1.6, temperature: 0.5, tint: -0.4 } as const;
const set = randomSplats({ count: 40, seed: 4, shDegree: 2 });

test('a graded set has, from every direction, the colours that the effect gives', () => {
  const graded = gradeSplats(set, OPTIONS);
  const change = reference(OPTIONS).changeColor!;
  // Any weights of the harmonics: the values of some direction.
  const weights = [0.3, -0.5, 0.2, 0.7, -0.1, 0.4, -0.9, 0.6];
  const colorIn = ({ colorDc, harmonics }: typeof set, i: number) =>
    [0, 1, 2].map((channel) =>
      weights.reduce(
        (sum, weight, k) => sum + weight * harmonics.coefficients[24 * i + 3 * k + channel],
        colorOf(colorDc[3 * i + channel]),
      ),
    ) as unknown as [number, number, number];
  for (let i = 0; i < set.count; i++) {
    const expected = change(colorIn(set, i), null as never, i, [0, 0, -1]);
    for (const [channel, value] of colorIn(graded as typeof set, i).entries())
      expect(value).toBeCloseTo(expected[channel], 5);
  }
});

test('a grade that changes nothing returns the set itself, and no reason for the effect', () => {
  expect(gradeSplats(set, {})).toBe(set);
  expect(grade({ saturation: 1, exposure: 0 }).reason).toBeNull();
  expect(grade({ exposure: -1 }).reason).toContain('-1 stops');
});

describe('the matrix', () => {
  const applied = (options: Parameters<typeof gradeMatrix>[0], color: readonly [number, number, number]) =>
    reference(options).changeColor!(color, null as never, 0, [0, 0, -1]);
  const brightness = ([r, g, b]: readonly number[]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

  test('keeps greys grey under saturation, and their brightness under white balance', () => {
    for (const value of applied({ saturation: 0.2 }, [0.4, 0.4, 0.4])) expect(value).toBeCloseTo(0.4, 12);
    const [r, g, b] = applied({ saturation: 0 }, [0.9, 0.1, 0.4]);
    expect([g, b]).toEqual([r, r]);
    const warm = applied({ temperature: 1 }, [0.5, 0.5, 0.5]);
    expect(warm[0]).toBeGreaterThan(warm[2] + 0.05);
    expect(brightness(warm)).toBeCloseTo(0.5, 12);
    const magenta = applied({ tint: 1 }, [0.5, 0.5, 0.5]);
    expect(magenta[0]).toBeGreaterThan(magenta[1] + 0.03);
  });

  test('doubles light by a stop', () => {
    expect(applied({ exposure: 2.2 }, [0.2, 0.1, 0])).toEqual([0.4, 0.2, 0]);
  });
});

test.each([
  [{ exposure: Number.NaN }, 'exposure is NaN'],
  [{ saturation: -1 }, 'saturation is -1'],
  [{ temperature: 1.5 }, 'temperature is 1.5'],
  [{ tint: '1' as never }, 'tint'],
  [{ contrast: 1 } as never, 'no option contrast'],
])('%o is rejected', (options, message) => {
  expect(() => gradeSplats(set, options)).toThrow(InvalidArgumentError);
  expect(() => grade(options)).toThrow(message);
});
