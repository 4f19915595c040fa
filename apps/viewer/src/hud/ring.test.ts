import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { Ring } from './frame-recorder.ts';

describe('a ring', () => {
  it('keeps the last values in their order', () => {
    fc.assert(
      fc.property(fc.array(fc.integer()), fc.integer({ min: 1, max: 8 }), (values, capacity) => {
        const ring = new Ring<number>(capacity);
        for (const value of values) ring.push(value);
        expect(ring.toArray()).toEqual(values.slice(-capacity));
      }),
    );
  });

  it('begins anew when it is cleared', () => {
    const ring = new Ring<number>(2);
    for (const value of [1, 2, 3]) ring.push(value);
    ring.clear();
    expect(ring.toArray()).toEqual([]);
    ring.push(4);
    expect(ring.toArray()).toEqual([4]);
  });
});
