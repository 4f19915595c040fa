import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { reference } from './fog.reference.ts';
import { type FogOptions, fog } from './fog.ts';

const SPLAT = {
  position: [0, 0, 0],
  opacity: 1,
  row: 0,
  rotation: [1, 0, 0, 0],
  logScales: [0, 0, 0],
} as const;
const WHITE: Vec3 = [1, 1, 1];
const BLACK: Vec3 = [0, 0, 0];
const colorAt = (depthView: number, options: FogOptions, color: Vec3 = BLACK) =>
  reference(options).changeColor!(color, SPLAT, 0, [7, -7, -depthView]);

describe('fog', () => {
  test('begins at near and is complete at far', () => {
    const options = { color: [0.2, 0.4, 0.6], near: 2, far: 6 } as const;
    const expectAt = (depth: number, color: Vec3) => {
      for (const [channel, value] of colorAt(depth, options, [1, 0.5, 0]).entries())
        expect(value).toBeCloseTo(color[channel], 12);
    };
    for (const depth of [-1, 0, 2]) expectAt(depth, [1, 0.5, 0]);
    for (const depth of [6, 1e9]) expectAt(depth, options.color);
  });

  test('is mixed in linear light: half of white is 0.7354', () => {
    expect(colorAt(4, { color: WHITE, near: 2, far: 6 })[0]).toBeCloseTo(0.735357, 5);
    // At a quarter of the way smoothstep is 0.15625, which is encoded as 0.4320.
    expect(colorAt(3, { color: WHITE, near: 2, far: 6 })[0]).toBeCloseTo(0.432, 3);
  });

  test('of a density leaves e^−(density·depth)² of the light', () => {
    // Half of the light is left if (density·depth)² = ln 2.
    expect(colorAt(Math.sqrt(Math.LN2) / 0.25, { color: WHITE, density: 0.25 })[0]).toBeCloseTo(0.735357, 5);
    expect(colorAt(0, { color: WHITE, density: 0.25 })[0]).toBe(0);
    expect(colorAt(1e5, { color: WHITE, density: 0.25 })[0]).toBeCloseTo(1, 12);
  });

  test('has a reason if there is any fog', () => {
    expect(fog({ color: WHITE, near: 1, far: 2 }).reason).toBe('there is fog between depths of 1 and 2');
    expect(fog({ color: WHITE, density: 0.1 }).reason).toBe('there is fog of density 0.1');
    expect(fog({ color: WHITE, density: 0 }).reason).toBeNull();
  });

  const refused: Readonly<Record<string, readonly [object, RegExp]>> = {
    'no colour': [{ density: 1 }, /^color is undefined; /],
    'a negative colour': [{ color: [0, -1, 0], density: 1 }, /^color is \[0, -1, 0\]; .*none below 0/],
    'a negative density': [{ color: WHITE, density: -1 }, /^density is -1; .*0 or more/],
    'an infinite density': [
      { color: WHITE, density: Number.POSITIVE_INFINITY },
      /^density is Infinity; .*finite/,
    ],
    'both kinds': [{ color: WHITE, density: 1, near: 1, far: 2 }, /^density is 1; .*instead of near and far/],
    'neither kind': [{ color: WHITE }, /^near is undefined; /],
    'near beyond far': [{ color: WHITE, near: 2, far: 1 }, /^far is 1; .*above near, 2/],
    'no way from near to far': [{ color: WHITE, near: 1, far: 1 }, /^far is 1; /],
    'no end': [{ color: WHITE, near: 1, far: Number.POSITIVE_INFINITY }, /^far is Infinity; .*finite/],
  };
  for (const [what, [options, message]] of Object.entries(refused))
    test(`rejects ${what}`, () => {
      expect(() => fog(options as FogOptions)).toThrow(InvalidArgumentError);
      expect(() => fog(options as FogOptions)).toThrow(message);
    });
});
