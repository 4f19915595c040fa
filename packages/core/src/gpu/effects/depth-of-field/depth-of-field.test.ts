import { describe, expect, test } from 'vitest';
import { perspectiveCamera } from '../../../data/camera/camera.ts';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { renderReference } from '../../../reference/index.ts';
import { splatsOf } from '../../../testing/random-splats.ts';
import { type DepthOfFieldOptions, depthOfField } from './depth-of-field.ts';

const SIZE = { widthPx: 96, heightPx: 96 };
const CAMERA = perspectiveCamera({ position: [0, 0, 4], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
const FOCAL_PX = SIZE.heightPx / 2 / Math.tan((25 * Math.PI) / 180);

/** Sum of opacities over the image, and their variance along x and y, px², of one small splat. */
function spreadOf(options: DepthOfFieldOptions, z = 0) {
  const set = splatsOf([{ logScales: [-2.8, -2.8, -2.8], position: [0, 0, z] }]);
  const clouds = [{ set, effects: [depthOfField(options)] }];
  // Splats end where their opacity is less than a byte shows; their light does not.
  const settings = { alphaCutoff: 1e-7 };
  const { data } = renderReference({ clouds, camera: CAMERA, settings, ...SIZE });
  const sums = { light: 0, x: 0, y: 0 };
  for (let pixel = 0; pixel < SIZE.widthPx * SIZE.heightPx; pixel++) {
    const alpha = data[4 * pixel + 3];
    sums.light += alpha;
    sums.x += alpha * ((pixel % SIZE.widthPx) + 0.5 - SIZE.widthPx / 2) ** 2;
    sums.y += alpha * (Math.floor(pixel / SIZE.widthPx) + 0.5 - SIZE.heightPx / 2) ** 2;
  }
  return { light: sums.light, x: sums.x / sums.light, y: sums.y / sums.light };
}

describe('depth of field', () => {
  const sharp = spreadOf({ aperture: 0, focusDistance: 4 });

  test('leaves splats in focus as they are', () => {
    const focused = spreadOf({ aperture: 0.4, focusDistance: 4 });
    expect(focused).toEqual(sharp);
  });

  for (const [where, focusDistance] of [
    ['behind the focus', 3],
    ['in front of the focus', 6],
  ] as const)
    test(`spreads the light of splats ${where} over the circle of a thin lens, and keeps it`, () => {
      const aperture = 0.3;
      const blurred = spreadOf({ aperture, focusDistance });
      const radiusPx = FOCAL_PX * aperture * Math.abs(1 / focusDistance - 1 / 4);
      expect(radiusPx).toBeGreaterThan(2);
      expect(blurred.light / sharp.light).toBeCloseTo(1, 2);
      expect(blurred.x - sharp.x).toBeCloseTo(radiusPx ** 2 / 4, 1);
      expect(blurred.y - sharp.y).toBeCloseTo(radiusPx ** 2 / 4, 1);
    });

  test('is off without an aperture, and tells its lens', () => {
    expect(depthOfField({ aperture: 0, focusDistance: 1 }).reason).toBeNull();
    expect(depthOfField({ aperture: 0.1, focusDistance: 2 }).reason).toBe(
      'a lens of radius 0.1 is focused at 2',
    );
  });

  const refused: Readonly<Record<string, readonly [object, RegExp]>> = {
    'no aperture': [{ focusDistance: 1 }, /^aperture is undefined; .*0 or more/],
    'a negative aperture': [{ aperture: -1, focusDistance: 1 }, /^aperture is -1; /],
    'an infinite aperture': [{ aperture: Number.POSITIVE_INFINITY, focusDistance: 1 }, /^aperture is Inf/],
    'no focus': [{ aperture: 1 }, /^focusDistance is undefined; .*above 0/],
    'a focus at the eye': [{ aperture: 1, focusDistance: 0 }, /^focusDistance is 0; /],
    'a focus that is no number': [{ aperture: 1, focusDistance: Number.NaN }, /^focusDistance is NaN; /],
  };
  for (const [what, [options, message]] of Object.entries(refused))
    test(`rejects ${what}`, () => {
      expect(() => depthOfField(options as DepthOfFieldOptions)).toThrow(InvalidArgumentError);
      expect(() => depthOfField(options as DepthOfFieldOptions)).toThrow(message);
    });
});
