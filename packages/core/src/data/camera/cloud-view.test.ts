import { describe, expect, test } from 'vitest';
import { TEST_MODELS } from '../../testing/test-cameras.ts';
import { identity4, linearPart, type Mat4, transform3, translated4, type Vec3 } from '../math/mat4.ts';
import { polarDecomposition } from '../math/polar-decomposition.ts';
import { perspectiveCamera } from './camera.ts';
import { cloudView } from './cloud-view.ts';

const CAMERA = perspectiveCamera({ position: [3, -2, 5], target: [0.5, 1, -2], fovYDegrees: 40, aspect: 1 });
const ORIGIN: Vec3 = [10, -20, 30];

function toViewOf(view: ReturnType<typeof cloudView>, point: readonly number[]): Vec3 {
  const [x, y, z] = transform3(view.linear, point);
  return [x + view.translation[0], y + view.translation[1], z + view.translation[2]];
}

function unit([x, y, z]: Vec3): Vec3 {
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

describe('cloudView', () => {
  for (const [name, modelMatrix] of Object.entries(TEST_MODELS)) {
    test(`${name} model: the camera, in cloud space, is at the origin of view space`, () => {
      const view = cloudView(CAMERA.viewMatrix, modelMatrix, ORIGIN, false);
      for (const value of toViewOf(view, view.camera!)) expect(Math.abs(value)).toBeLessThan(1e-12);
    });

    test(`${name} model: harmonics are seen along the world's lines of sight, turned by the model`, () => {
      const { rotation } = polarDecomposition(linearPart(modelMatrix))!;
      const toView = linearPart(CAMERA.viewMatrix);
      const isAlike = (seen: Vec3, expected: Vec3) => {
        const [x, y, z] = unit(transform3(toView, transform3(rotation, seen)));
        const [a, b, c] = unit(expected);
        expect([x, y, z]).toEqual([expect.closeTo(a, 12), expect.closeTo(b, 12), expect.closeTo(c, 12)]);
      };
      for (const isOrthographic of [false, true]) {
        const view = cloudView(CAMERA.viewMatrix, modelMatrix, ORIGIN, isOrthographic);
        isAlike(view.direction, [0, 0, -1]);
        expect(view.camera === null).toBe(isOrthographic);
      }
      const view = cloudView(CAMERA.viewMatrix, modelMatrix, ORIGIN, false);
      for (const point of [
        [1, 2, 3],
        [-40, 5, 0.5],
      ] as const) {
        const [x, y, z] = view.camera!;
        isAlike(transform3(view.sight, [point[0] - x, point[1] - y, point[2] - z]), toViewOf(view, point));
      }
    });
  }

  test('positions are relative to the origin of the cloud', () => {
    const view = cloudView(CAMERA.viewMatrix, identity4(), ORIGIN, false);
    const about = cloudView(CAMERA.viewMatrix, identity4(), [0, 0, 0], false);
    const point = [1, 2, 3];
    const expected = toViewOf(
      about,
      point.map((p, axis) => p + ORIGIN[axis]),
    );
    for (const [axis, value] of toViewOf(view, point).entries())
      expect(value).toBeCloseTo(expected[axis], 12);
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

  test('lines of sight keep their bits where a model scales all axes alike', () => {
    const turned = Float64Array.of(0, 3, 0, 0, 0, 0, 3, 0, 3, 0, 0, 0, 7, 8, 9, 1);
    for (const model of [TEST_MODELS.identity, TEST_MODELS.mirrored, turned]) {
      const { sight } = cloudView(CAMERA.viewMatrix, model, ORIGIN, false);
      expect(sight).toEqual([1, 0, 0, 0, 1, 0, 0, 0, 1]);
    }
  });

  test('a singular model still has a viewing direction', () => {
    const flat = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1);
    const view = cloudView(CAMERA.viewMatrix, flat, ORIGIN, false);
    expect(view.camera).toBeNull();
    expect(view.direction).toEqual([0, 0, 0]);
  });
});
