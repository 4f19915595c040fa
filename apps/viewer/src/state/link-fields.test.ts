import { InvalidArgumentError, resolveAccuracy } from '@websplatter/core';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import { describeDetail } from '../ui/accuracy-words.ts';
import { FIRST_LOOK } from './camera.ts';
import { LINK_FIELDS } from './link-fields.ts';
import type { LinkedCamera } from './saved-view.ts';

const { encode: encodeCamera, decode: decodeCamera } = LINK_FIELDS.camera;
const { encode: encodeComparison, decode: decodeComparison } = LINK_FIELDS.compare;
const { encode: encodeDetail, decode: decodeDetail } = LINK_FIELDS.detail;

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
    const number = fc.double({ noNaN: true, min: -1e38, max: 1e38 }).map((value) => value + 0);
    const camera = fc.record({
      pose: fc.record({
        target: fc.tuple(number, number, number),
        distance: fc.double({ min: 1e-300, max: 1e38, noNaN: true }),
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
    ['0,-1e308,0,10,0,1', '-1e308 is no number of float32'],
    ['0,0,0,1e39,0,1', '1e39 is no number of float32'],
    ['3e38,0,0,3e38,0,1', 'a distance of 3e+38 are beyond float32'],
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

const balanced = resolveAccuracy('balanced');
const coarse = resolveAccuracy({ preset: 'fast', resolutionScale: 0.5 });

describe('a comparison in the address', () => {
  it.each([
    ['error', { comparison: { kind: 'error' }, splitPart: 0.5 }],
    [
      'current/balanced/0.25',
      { comparison: { kind: 'split', left: 'current', right: balanced }, splitPart: 0.25 },
    ],
    [
      'fast,resolutionScale:0.5/current/1',
      { comparison: { kind: 'split', left: coarse, right: 'current' }, splitPart: 1 },
    ],
  ] as const)('is %s, and comes back', (text, linked) => {
    expect(encodeComparison(linked)).toBe(text);
    expect(decodeComparison(text)).toEqual(linked);
  });

  it('has its line in the middle where none is named', () => {
    expect(decodeComparison('current/fast').splitPart).toBe(0.5);
  });

  it.each([
    ['', 'two sides'],
    ['fast', 'two sides'],
    ['fast/fast/0.5/1', 'two sides'],
    ['fast/high/', 'its line'],
    ['fast/high/2', 'its line, “2”'],
    ['fast/minPsnrDb:45', 'is a target'],
    ['fast/best', 'best'],
  ])('refuses %j with what is wrong', (text, why) => {
    expect(() => decodeComparison(text)).toThrow(InvalidArgumentError);
    expect(() => decodeComparison(text)).toThrow(why);
  });
});

describe('detail in the address', () => {
  it.each([
    [{ maxSplats: 1_200_000 }, 'maxSplats:1200000', 'at most 1.2 million splats'],
    [{ maxSplats: 5000 }, 'maxSplats:5000', 'at most 5,000 splats'],
    ['full', 'full', ''],
    ['auto', 'auto', 'automatic detail'],
    [{ maxShare: 0.25 }, 'maxShare:0.25', 'at most 25 % of the splats in sight'],
    [{ maxFrameMs: 8 }, 'maxFrameMs:8', 'splats for 8 ms'],
    [{ minPsnrDb: 40 }, 'minPsnrDb:40', 'splats for 40 dB'],
    [{ maxErrorPx: 0.5 }, 'maxErrorPx:0.5', 'errors up to 0.5 px'],
    [
      { maxErrorPx: 0.1, maxSplats: 999_950 },
      'maxErrorPx:0.1,maxSplats:999950',
      'errors up to 0.1 px, at most 1.0 million splats',
    ],
  ] as const)('writes %o as %s, and for people', (detail, text, words) => {
    expect(encodeDetail(detail)).toBe(text);
    expect(decodeDetail(text)).toEqual(detail);
    expect(describeDetail(detail)).toBe(words);
  });

  it.each([
    '',
    'half',
    'maxSplats:',
    'maxSplats:many',
    'maxSplats:1e999',
    'maxSplats:0.5',
    'maxErrorPx:-1',
    'minPsnrDb:40,maxSplats:500',
  ])('refuses %j with what would do', (text) => {
    expect(() => decodeDetail(text)).toThrow(InvalidArgumentError);
    expect(() => decodeDetail(text)).toThrow('{ maxSplats: 1e6 }');
  });
});
