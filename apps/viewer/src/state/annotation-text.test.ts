import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import type { Annotation } from './annotating.ts';
import { decodeAnnotation, encodeAnnotation } from './annotation-text.ts';

const VIEW = { pose: FRONT, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false };
const NAMELESS: Annotation = { point: [0.1 + 0.2, -1, 0], title: '', text: '', view: VIEW };

describe('an annotation in the address', () => {
  it('is its place, its view, and words of any characters', () => {
    expect(encodeAnnotation(NAMELESS)).toBe('0.3:-1:0,0,0,0,10,0,1.5708');
    const named = { ...NAMELESS, title: 'Jug, c. 1900', text: 'Two lines:\n,words:x' };
    const text = encodeAnnotation(named);
    expect(text).toBe('0.3:-1:0,0,0,0,10,0,1.5708,words:Jug, c. 1900\nTwo lines:\n,words:x');
    expect(decodeAnnotation(text)).toMatchObject({ title: named.title, text: named.text });
  });

  it('is read as it was written', () => {
    const coordinate = fc.double({ min: -1e3, max: 1e3, noNaN: true });
    const point = fc.tuple(coordinate, coordinate, coordinate);
    const title = fc.string().filter((each) => !/[\r\n]/.test(each));
    fc.assert(
      fc.property(fc.record({ point, title, text: fc.string() }), (each) => {
        const written = encodeAnnotation({ ...each, view: VIEW });
        const read = decodeAnnotation(written);
        expect(encodeAnnotation(read)).toBe(written);
        expect(read).toMatchObject({ title: each.title.trim(), text: each.text.trim() });
        for (const [axis, value] of read.point.entries()) expect(value).toBeCloseTo(each.point[axis], 3);
      }),
    );
  });

  it('is refused without a place or a view', () => {
    expect(() => decodeAnnotation('0:1,0,0,0,10,0,1.5')).toThrow('0:1 is not three numbers');
    expect(() => decodeAnnotation('0:1:2,words:Here')).toThrow('a number is missing');
  });
});
