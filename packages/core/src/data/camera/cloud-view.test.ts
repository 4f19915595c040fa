import { describe, expect, test } from 'vitest';
import { TEST_MODELS } from '../../testing/test-cameras.ts';
import { identity4, type Mat4, transform3, translated4, type Vec3 } from '../math/mat4.ts';
import { perspectiveCamera } from './camera.ts';
import { cloudView } from './cloud-view.ts';

const CAMERA = perspectiveCamera({ position: [3, -2, 5], target: [0.5, 1, -2], fovYDegrees: 40, aspect: 1 });
const ORIGIN: Vec3 = [10, -20, 30];

function toView(view: ReturnType<typeof cloudView>, point: readonly number[]): number[] {
  return transform3(view.linear, point).map((v, axis) => v + view.translation[axis]);
}

describe('cloudView', () => {
  for (const [name, modelMatrix] of Object.entries(TEST_MODELS)) {
    test(`${name} model: the camera, in cloud space, is at the origin of view space`, () => {
      const view = cloudView(CAMERA.viewMatrix, modelMatrix, ORIGIN, false);
      for (const value of toView(view, view.camera!)) expect(Math.abs(value)).toBeLessThan(1e-12);
    });

    test(`${name} model: the direction, in view space, is straight ahead`, () => {
      for (const isOrthographic of [false, true]) {
        const view = cloudView(CAMERA.viewMatrix, modelMatrix, ORIGIN, isOrthographic);
        const [x, y, z] = transform3(view.linear, view.direction);
        expect([x, y, z]).toEqual([expect.closeTo(0, 12), expect.closeTo(0, 12), expect.closeTo(-1, 12)]);
        expect(view.camera === null).toBe(isOrthographic);
      }
    });
  }

  test('positions are relative to the origin of the cloud', () => {
    const view = cloudView(CAMERA.viewMatrix, identity4(), ORIGIN, false);
    const about = cloudView(CAMERA.viewMatrix, identity4(), [0, 0, 0], false);
    const point = [1, 2, 3];
    const expected = toView(
      about,
      point.map((p, axis) => p + ORIGIN[axis]),
    );
    for (const [axis, value] of toView(view, point).entries()) expect(value).toBeCloseTo(expected[axis], 12);
  });

  test('millimetres survive 6,400 km from the origin of the world', () => {
    const far: Vec3 = [6.4e6, -6.4e6, 6.4e6];
    const atOrigin = cloudView(CAMERA.viewMatrix, identity4(), [0, 0, 0], false);
    const viewMatrix = translated4(CAMERA.viewMatrix, [-far[0], -far[1], -far[2]]);
    const model: Mat4 = identity4();
    model.set(far, 12);
    for (const view of [
      cloudView(viewMatrix, model, [0, 0, 0], false),
      cloudView(viewMatrix, identity4(), far, false),
    ]) {
      for (const axis of [0, 1, 2])
        expect(Math.abs(view.translation[axis] - atOrigin.translation[axis])).toBeLessThan(1e-8);
    }
  });

  test('a singular model still has a viewing direction', () => {
    const flat = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1);
    const view = cloudView(CAMERA.viewMatrix, flat, ORIGIN, false);
    expect(view.camera).toBeNull();
    expect(view.direction).toEqual([0, 0, 0]);
  });
});
