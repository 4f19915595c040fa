import { InvalidArgumentError } from '@websplatter/core';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { decodeCrop, encodeCrop } from './crop-text.ts';

describe('a crop in the address', () => {
  it('is both corners and what stays', () => {
    const crop = { min: [-1, 0, 0.1], max: [1, 2, 3e-7], keep: 'inside' } as const;
    expect(encodeCrop(crop)).toBe('-1:0:0.1:1:2:3e-7:inside');
  });

  it('comes back with the bits that it had, whatever it is', () => {
    // −0 is written as 0.
    const number = fc.double({ noNaN: true, noDefaultInfinity: true }).map((value) => value + 0);
    const side = fc.tuple(number, number).map(([a, b]) => (a < b ? [a, b] : [b, a]));
    fc.assert(
      fc.property(side, side, side, fc.constantFrom('inside', 'outside'), (x, y, z, keep) => {
        const crop = { min: [x[0], y[0], z[0]], max: [x[1], y[1], z[1]], keep } as const;
        expect(decodeCrop(encodeCrop(crop))).toEqual(crop);
      }),
    );
  });

  it.each([
    ['', '1 parts'],
    ['0:0:0:1:1:1', '6 parts'],
    ['0:0:0:1:1:x:inside', '“x” is no number'],
    ['0:0:0:1:1::inside', 'a number is missing'],
    ['0:0:0:1:1:1:both', '“both” is neither'],
    ['0:2:0:1:1:1:inside', 'min y, 2, is above its max, 1'],
  ])('refuses %j with what is wrong and what would do', (text, why) => {
    expect(() => decodeCrop(text)).toThrow(InvalidArgumentError);
    expect(() => decodeCrop(text)).toThrow(why);
    expect(() => decodeCrop(text)).toThrow('write crop=x:y:z');
  });
});
