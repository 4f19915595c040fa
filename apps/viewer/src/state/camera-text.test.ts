import { InvalidArgumentError } from '@websplatter/core';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import { FIRST_LOOK } from './camera.ts';
import { decodeCamera, encodeCamera } from './camera-text.ts';
import type { LinkedCamera } from './saved-view.ts';

const USUAL: LinkedCamera = {
  pose: FRONT,
  fovDegrees: FIRST_LOOK.fovDegrees,
  isOrthographic: false,
  cameraIndex: 0,
  isFlipped: false,
  isZUp: false,
};

describe('a camera in the address', () => {
  it('is six numbers where all else is as usual', () => {
    expect(encodeCamera(USUAL)).toBe('0,0,0,10,0,1.5707963267948966');
  });

  it('names what is not as usual', () => {
    const camera = { ...USUAL, fovDegrees: 40, cameraIndex: 2, isFlipped: true, isOrthographic: true };
    const text = encodeCamera({ ...camera, pose: { ...FRONT, up: [0, 0, 1] } });
    expect(text).toBe('0,0,0,10,0,1.5707963267948966,up:0:0:1,fov:40,parallel:1,flipped:1,own:2');
    expect(decodeCamera(text)).toEqual({ ...camera, pose: { ...FRONT, up: [0, 0, 1] } });
  });

  it('comes back with the bits that it had, whatever it is', () => {
    // −0 is written as 0.
    const number = fc.double({ noNaN: true, noDefaultInfinity: true }).map((value) => value + 0);
    const camera = fc.record({
      pose: fc.record({
        target: fc.tuple(number, number, number),
        distance: fc.double({ min: 1e-300, max: 1e300, noNaN: true }),
        azimuth: number,
        polar: fc.double({ min: 0.01, max: 3.13, noNaN: true }),
        up: fc
          .double({ min: 0, max: 6, noNaN: true })
          .map((turn) => [0, Math.cos(turn), Math.sin(turn)] as const),
      }),
      fovDegrees: fc.double({ min: 1e-3, max: 179, noNaN: true }),
      cameraIndex: fc.nat(20),
      isOrthographic: fc.boolean(),
      isFlipped: fc.boolean(),
      isZUp: fc.boolean(),
    });
    fc.assert(
      fc.property(camera, (each) => {
        expect(decodeCamera(encodeCamera(each))).toEqual(each);
      }),
    );
  });

  it.each([
    ['', 'a number is missing'],
    ['0,0,0,10,0', 'a number is missing'],
    ['0,0,0,10,0,x', '“x” is no number'],
    ['0,0,0,1e999,0,1', '“1e999” is no number'],
    ['0,0,0,0,0,1', 'distance, 0'],
    ['0,0,0,10,0,4', 'polar angle, 4'],
    ['0,0,0,10,0,1,best', '“best”'],
    ['0,0,0,10,0,1,up:0:0', 'up:0:0 is no direction'],
    ['0,0,0,10,0,1,up:0:2:0', 'up:0:2:0 is no direction'],
    ['0,0,0,10,0,1,fov:180', 'fov:180'],
    ['0,0,0,10,0,1,own:0.5', 'own:0.5'],
  ])('refuses %j with what is wrong and what would do', (text, why) => {
    expect(() => decodeCamera(text)).toThrow(InvalidArgumentError);
    expect(() => decodeCamera(text)).toThrow(why);
    expect(() => decodeCamera(text)).toThrow('write camera=x,y,z');
  });
});
