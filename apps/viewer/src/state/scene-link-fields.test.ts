import { InvalidArgumentError } from '@websplatter/core';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { expectClose, FRONT } from '../camera/orbit-pose.fixture.ts';
import type { Annotation } from './annotating.ts';
import { lookAt } from './orbit-pose.ts';
import type { SavedView } from './saved-view.ts';
import { SCENE_LINK_FIELDS } from './scene-link-fields.ts';

const { encode: encodeCrop, decode: decodeCrop } = SCENE_LINK_FIELDS.crop;
const { encode: encodeView, decode: decodeView } = SCENE_LINK_FIELDS.view;
const { encode: encodeAnnotation, decode: decodeAnnotation } = SCENE_LINK_FIELDS.annotation;

/** Numbers that shaders take. */
const LARGEST_F32 = (2 - 2 ** -23) * 2 ** 127;

describe('a crop in the address', () => {
  it('is both corners and what stays', () => {
    const crop = { min: [-1, 0, 0.1], max: [1, 2, 3e-7], keep: 'inside' } as const;
    expect(encodeCrop(crop)).toBe('-1:0:0.1:1:2:3e-7:inside');
  });

  it('comes back with the bits that it had, whatever it is', () => {
    // −0 is written as 0.
    const number = fc.double({ noNaN: true, min: -LARGEST_F32, max: LARGEST_F32 }).map((value) => value + 0);
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
    ['-1e308:0:0:1:1:1:inside', '-1e308 is no number of float32'],
    ['0:0:0:1:1:1:both', '“both” is neither'],
    ['0:2:0:1:1:1:inside', 'min y, 2, is above its max, 1'],
  ])('refuses %j with what is wrong and what would do', (text, why) => {
    expect(() => decodeCrop(text)).toThrow(InvalidArgumentError);
    expect(() => decodeCrop(text)).toThrow(why);
    expect(() => decodeCrop(text)).toThrow('write crop=x:y:z');
  });
});

const SAVED: SavedView = {
  ...{ pose: FRONT, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false },
  ...{ name: '', thumbnail: null },
};

const coordinate = fc.double({ min: -1e4, max: 1e4, noNaN: true });
const view: fc.Arbitrary<SavedView> = fc.record({
  pose: fc.record({
    target: fc.tuple(coordinate, coordinate, coordinate),
    distance: fc.double({ min: 1e-3, max: 1e5, noNaN: true }),
    azimuth: fc.double({ min: -20, max: 20, noNaN: true }),
    polar: fc.double({ min: 0.01, max: 3.13, noNaN: true }),
    up: fc.constant([0, 1, 0] as const),
  }),
  fovDegrees: fc.double({ min: 1, max: 179, noNaN: true }),
  isOrthographic: fc.boolean(),
  isFlipped: fc.boolean(),
  isZUp: fc.boolean(),
  name: fc.string(),
  thumbnail: fc.constant(null),
  toNextMs: fc.integer({ min: 100, max: 100_000 }),
  passing: fc.constantFrom('through', 'stop', 'cut' as const),
});

describe('a path in the address', () => {
  const { encode, decode } = SCENE_LINK_FIELDS.path;
  const { name, thumbnail, ...kept } = SAVED;
  const turntable = { view: kept, durationMs: 12_500 };

  it.each([
    [{ isLooped: false, turntable: null }, null],
    [{ isLooped: true, turntable: null }, 'loop'],
    [{ isLooped: false, turntable }, 'turntable:12.5,0,0,0,10,0,1.5708'],
    [{ isLooped: true, turntable }, 'loop,turntable:12.5,0,0,0,10,0,1.5708'],
  ] as const)('%j is %j, and comes back', (path, text) => {
    expect(encode(path)).toBe(text);
    if (text === null) return;
    const back = decode(text);
    expect(back.isLooped).toBe(path.isLooped);
    expect(back.turntable?.durationMs).toBe(path.turntable?.durationMs);
    if (back.turntable) expectClose(lookAt(back.turntable.view.pose).position, [0, 0, 10], 1e-3);
  });

  it.each([
    ['', 'neither loop nor a turntable'],
    ['round', '“round” is neither loop nor a turntable'],
    ['turntable:0,0,0,0,10,0,1', '0 seconds are too short'],
    ['turntable:x,0,0,0,10,0,1', '“x” is no number'],
    ['turntable:10,0,0,0,1e300,0,1', '1e300 is no number of float32'],
    ['turntable:10,0,0', 'a number is missing'],
  ])('refuses %j: %s', (text, why) => {
    expect(() => decode(text)).toThrow(InvalidArgumentError);
    expect(() => decode(text)).toThrow(why);
  });
});

describe('a saved view in the address', () => {
  it('is short, and has a name of any characters', () => {
    const pose = { ...FRONT, azimuth: 1 / 3, target: [0.1 + 0.2, 0, -0] as const };
    const named = { ...SAVED, pose, isFlipped: true, name: ' 1,5 m: the door,name:x ' };
    expect(encodeView(named)).toBe('0.3,0,0,10,0.33333,1.5708,flipped:1,name:1,5 m: the door,name:x');
    expect(decodeView(encodeView(named)).name).toBe('1,5 m: the door,name:x');
    expect(encodeView(SAVED)).toBe('0,0,0,10,0,1.5708');
  });

  it('has how the path goes on from it only where that is not as usual', () => {
    const key = { ...SAVED, name: 'Door', toNextMs: 400, passing: 'cut' } as const;
    expect(encodeView(key)).toBe('0,0,0,10,0,1.5708,next:0.4,pass:cut,name:Door');
    expect(decodeView(encodeView(key))).toMatchObject({ name: 'Door', toNextMs: 400, passing: 'cut' });
    expect(encodeView({ ...SAVED, toNextMs: 2500, passing: 'through' })).toBe('0,0,0,10,0,1.5708');
    // Links of before have neither.
    expect(Object.keys(decodeView('0,0,0,10,0,1.5708')).toSorted()).toEqual(Object.keys(SAVED).toSorted());
    expect(() => decodeView('0,0,0,10,0,1.5708,next:0')).toThrow('next:0 is below 0.1 seconds');
    expect(() => decodeView('0,0,0,10,0,1.5708,pass:by')).toThrow('pass:by is none of through, stop, cut');
  });

  it('looks as it was saved, and is written the same again', () => {
    fc.assert(
      fc.property(view, (each) => {
        const text = encodeView(each);
        const read = decodeView(text);
        expect(encodeView(read)).toBe(text);
        expect(read).toMatchObject({ name: each.name.trim(), isZUp: each.isZUp, isFlipped: each.isFlipped });
        const [a, b] = [lookAt(read.pose), lookAt(each.pose)];
        expectClose(a.position, b.position, 1e-4 * each.pose.distance);
        expectClose(a.target, b.target, 1e-5 * each.pose.distance);
      }),
    );
  });

  it('is refused where it is no camera', () => {
    expect(() => decodeView('near,name:The door')).toThrow('“near” is no number');
  });
});

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
    expect(() => decodeAnnotation('0:1e308:2,0,0,0,10,0,1.5')).toThrow('1e308 is no number of float32');
  });
});
