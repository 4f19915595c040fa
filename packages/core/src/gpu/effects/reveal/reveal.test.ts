import { describe, expect, test } from 'vitest';
import { perspectiveCamera } from '../../../data/camera/camera.ts';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { identity4 } from '../../../data/math/mat4.ts';
import { reference } from './reveal.reference.ts';
import { type RevealOptions, reveal } from './reveal.ts';

const { viewMatrix } = perspectiveCamera({
  position: [0, 3, 4],
  target: [0, 0, 0],
  fovYDegrees: 40,
  aspect: 1,
});
const PLACE = {
  modelMatrix: identity4(),
  origin: [1, 0, 0],
  viewMatrix,
  projection: { isOrthographic: false, focalPx: [1, 1] },
} as const;
/** A splat at the world's origin. */
const SPLAT = {
  position: [-1, 0, 0],
  opacity: 0.8,
  row: 0,
  rotation: [1, 0, 0, 0],
  logScales: [-1, -2, -3],
} as const;
const revealed = (options: RevealOptions) => reference(options, PLACE).changeSplat!(SPLAT, 0);

describe('reveal', () => {
  test('shows splats nearer than the radius to a point or to the camera', () => {
    expect(revealed({ from: [0, 2, 0], radius: 1.9 }).opacity).toBe(0);
    expect(revealed({ from: [0, 2, 0], radius: 2.1 })).toEqual(SPLAT);
    expect(revealed({ from: 'camera', radius: 4.9 }).opacity).toBe(0);
    expect(revealed({ from: 'camera', radius: 5.1 })).toEqual(SPLAT);
  });

  test('lets splats fade in and grow within the soft edge', () => {
    const options = { from: [0, 2, 0], radius: 2.5, softEdge: 1 } as const;
    const { opacity, logScales } = revealed(options);
    expect(opacity).toBeCloseTo(0.4, 12);
    for (const axis of [0, 1, 2])
      expect(Math.exp(logScales[axis] - SPLAT.logScales[axis])).toBeCloseTo(0.5, 12);
    expect(revealed({ ...options, grow: false }).logScales).toEqual(SPLAT.logScales);
  });

  test('begins with nothing and ends with everything, even with a wide band', () => {
    expect(revealed({ from: [0, 0, 0], radius: 0, softEdge: 3 }).opacity).toBe(0);
    expect(revealed({ from: [0, 0, 0], radius: 0 }).opacity).toBe(0);
    expect(revealed({ from: [0, 0, 0], radius: 3, softEdge: 3 })).toEqual(SPLAT);
  });

  test('has a reason until its radius is infinite', () => {
    expect(reveal({ from: 'camera', radius: 2 }).reason).toBe('only what is within 2 of the camera is there');
    expect(reveal({ from: [1, 2, 3], radius: 0 }).reason).toBe('only what is within 0 of 1, 2, 3 is there');
    expect(reveal({ from: 'camera', radius: Number.POSITIVE_INFINITY }).reason).toBeNull();
  });

  test('never makes splats larger or moves them', () => {
    expect(reveal({ from: 'camera', radius: 2 }).reach).toEqual({ displacement: 0, growth: 1 });
  });

  const refused: Readonly<Record<string, readonly [object, RegExp]>> = {
    'another place': [{ from: 'centre', radius: 1 }, /^from is centre; .*"camera" or a point/],
    'no place': [{ radius: 1 }, /^from is undefined; /],
    'a place nowhere': [
      { from: [0, Number.NaN, 0], radius: 1 },
      /^from is \[0, NaN, 0\]; .*3 finite numbers/,
    ],
    'a negative radius': [{ from: 'camera', radius: -1 }, /^radius is -1; .*0 or more/],
    'a radius of no number': [{ from: 'camera', radius: Number.NaN }, /^radius is NaN; /],
    'no radius': [{ from: 'camera' }, /^radius is undefined; /],
    'an infinite band': [
      { from: 'camera', radius: 1, softEdge: Number.POSITIVE_INFINITY },
      /^softEdge is Infinity; .*finite/,
    ],
  };
  for (const [what, [options, message]] of Object.entries(refused))
    test(`rejects ${what}`, () => {
      expect(() => reveal(options as RevealOptions)).toThrow(InvalidArgumentError);
      expect(() => reveal(options as RevealOptions)).toThrow(message);
    });
});
