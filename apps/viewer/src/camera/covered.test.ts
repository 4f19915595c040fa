import { type Camera, orthographicCamera, perspectiveCamera } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import type { Vec3 } from '../state/vec3.ts';
import { besideCovered, CoveredGlide, coveredBeside, freeAspect, NOTHING_COVERED } from './covered.ts';

const PICTURE = { width: 900, height: 600 };
const FREE = { left: 90, top: 60, width: 422, height: 360 };
const COVERED = coveredBeside(FREE, PICTURE);

/** A camera's image of a point, px from the top left of an image of this size. */
function placeIn(
  { width, height }: typeof PICTURE,
  camera: Camera,
  [x, y, z]: Vec3,
): readonly [number, number] {
  const times = (m: ArrayLike<number>, v: readonly number[]) =>
    [0, 1, 2, 3].map((row) => v.reduce((sum, value, column) => sum + m[4 * column + row] * value, 0));
  const [clipX, clipY, , w] = times(camera.projectionMatrix, times(camera.viewMatrix, [x, y, z, 1]));
  return [((1 + clipX / w) * width) / 2, ((1 - clipY / w) * height) / 2];
}

describe('the covered part of the picture', () => {
  it('follows from the free area, in parts of the sides', () => {
    expect(COVERED.left).toBeCloseTo(0.1);
    expect(COVERED.right).toBeCloseTo(388 / 900);
    expect(COVERED.top).toBeCloseTo(0.1);
    expect(COVERED.bottom).toBeCloseTo(0.3);
    expect(coveredBeside({ left: 0, top: 0, ...PICTURE }, PICTURE)).toEqual(NOTHING_COVERED);
    expect(freeAspect(900 / 600, COVERED)).toBeCloseTo(422 / 360);
  });

  it('leaves some of the picture, however little is free', () => {
    expect(
      coveredBeside({ left: 0, top: 60, width: 360, height: 0 }, { width: 360, height: 640 }),
    ).toMatchObject({ left: 0, right: 0, top: expect.closeTo(0), bottom: 0.7 });
    expect(
      coveredBeside({ left: 260, top: 0, width: 0, height: 360 }, { width: 640, height: 360 }),
    ).toMatchObject({
      left: expect.closeTo(0.1063),
      right: expect.closeTo(0.5938),
    });
  });

  const from = { position: [1, 2, 4], target: [0.1, -0.2, 0.3], aspect: FREE.width / FREE.height } as const;
  it.each([
    ['perspective', perspectiveCamera({ ...from, fovYDegrees: 50 })],
    ['orthographic', orthographicCamera({ ...from, height: 3 })],
  ])('leaves free what a window of that size shows, in %s', (_, camera) => {
    const beside = besideCovered(camera, COVERED);
    for (const point of [from.target, [0, 0, 0], [1, -1, 1], [-2, 0.5, -3]] as const) {
      const [x, y] = placeIn(PICTURE, beside, point);
      const [freeX, freeY] = placeIn(FREE, camera, point);
      expect(x).toBeCloseTo(FREE.left + freeX, 9);
      expect(y).toBeCloseTo(FREE.top + freeY, 9);
    }
    const [x, y] = placeIn(PICTURE, beside, from.target);
    expect([x, y]).toEqual([
      expect.closeTo(FREE.left + FREE.width / 2),
      expect.closeTo(FREE.top + FREE.height / 2),
    ]);
    expect(beside).toMatchObject({ viewMatrix: camera.viewMatrix, near: camera.near, far: camera.far });
  });

  it('changes no camera where it is nothing', () => {
    const camera = perspectiveCamera({ ...from, fovYDegrees: 50 });
    expect(besideCovered(camera, NOTHING_COVERED)).toBe(camera);
  });
});

describe('the picture that makes room', () => {
  it('arrives after 200 ms, faster at first, from wherever it is', () => {
    const glide = new CoveredGlide();
    expect(glide.update(16)).toBe(false);
    glide.goTo({ ...NOTHING_COVERED, right: 0.4 }, false);
    expect(glide.now).toEqual(NOTHING_COVERED);
    expect(glide.update(100)).toBe(true);
    const half = glide.now.right;
    expect(half).toBeGreaterThan(0.2);
    glide.goTo(NOTHING_COVERED, false);
    expect(glide.now.right).toBeCloseTo(half);
    expect(glide.update(199)).toBe(true);
    expect(glide.now.right).toBeLessThan(0.001);
    expect(glide.update(1)).toBe(false);
    expect(glide.now).toBe(NOTHING_COVERED);
  });

  it('is there at once where that is asked for, in the middle of a glide too', () => {
    const glide = new CoveredGlide();
    glide.goTo(COVERED, false);
    glide.update(20);
    glide.goTo(COVERED, true);
    expect(glide.now).toBe(COVERED);
    expect(glide.update(16)).toBe(false);
  });
});
