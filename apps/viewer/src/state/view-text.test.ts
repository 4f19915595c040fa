import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { expectClose, FRONT } from '../camera/orbit-pose.fixture.ts';
import { lookAt } from './orbit-pose.ts';
import type { SavedView } from './saved-view.ts';
import { decodeView, encodeView } from './view-text.ts';

const VIEW: SavedView = {
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
});

describe('a saved view in the address', () => {
  it('is short, and has a name of any characters', () => {
    const pose = { ...FRONT, azimuth: 1 / 3, target: [0.1 + 0.2, 0, -0] as const };
    const named = { ...VIEW, pose, isFlipped: true, name: ' 1,5 m: the door,name:x ' };
    expect(encodeView(named)).toBe('0.3,0,0,10,0.33333,1.5708,flipped:1,name:1,5 m: the door,name:x');
    expect(decodeView(encodeView(named)).name).toBe('1,5 m: the door,name:x');
    expect(encodeView(VIEW)).toBe('0,0,0,10,0,1.5708');
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
