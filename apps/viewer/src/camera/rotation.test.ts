import fc from 'fast-check';
import { expect, it } from 'vitest';
import { cameraAxes, lookAt, poseFromLookAt } from '../state/orbit-pose.ts';
import { normalize, type Vec3 } from '../state/vec3.ts';
import { expectClose } from './orbit-pose.fixture.ts';
import { axesOf, poseOfAxes, quaternionOf } from './rotation.ts';

const number = fc.double({ min: -10, max: 10, noNaN: true });
const vector = fc.tuple(number, number, number).filter((each) => Math.hypot(...each) > 0.1);
/** Any turn, also by half a circle, where a quaternion's real part vanishes. */
const axes = fc
  .tuple(vector, vector)
  .filter(([back, up]) => Math.abs(back.reduce((sum, value, i) => sum + value * up[i], 0)) < 90)
  .map(([position, up]) => cameraAxes(poseFromLookAt({ position, target: [0, 0, 0], up })));

it('turns become quaternions and come back', () => {
  fc.assert(
    fc.property(axes, (each) => {
      const back = axesOf(quaternionOf(each));
      for (const name of ['right', 'above', 'back'] as const) expectClose(back[name], each[name], 1e-12);
    }),
  );
});

it.each([
  [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [0, 0, 0, 1],
  ],
  [
    [1, 0, 0],
    [0, -1, 0],
    [0, 0, -1],
    [1, 0, 0, 0],
  ],
  [
    [-1, 0, 0],
    [0, 1, 0],
    [0, 0, -1],
    [0, 1, 0, 0],
  ],
  [
    [-1, 0, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, 1, 0],
  ],
] as const)('the axes %j, %j, %j are the quaternion %j', (right, above, back, turn) => {
  expect(quaternionOf({ right, above, back }).map((value) => value + 0)).toEqual(turn);
});

it('orbits of cameras stand and look as the cameras do, and level ones turn around the scene’s up', () => {
  fc.assert(
    fc.property(axes, vector, fc.double({ min: 0.1, max: 50, noNaN: true }), (each, position, distance) => {
      const pose = poseOfAxes(position, each, distance, [0, 1, 0]);
      expectClose(lookAt(pose).position, position, 1e-9);
      for (const name of ['right', 'above', 'back'] as const)
        expectClose(cameraAxes(pose)[name], each[name], 1e-6);
    }),
  );
  const level = cameraAxes(poseFromLookAt({ position: [3, 2, 1], target: [0, 0, 0], up: [0, 1, 0] }));
  expect(poseOfAxes([3, 2, 1], level, 2, [0, 1, 0]).up).toEqual([0, 1, 0]);
  const rolled = {
    ...level,
    right: level.above,
    above: level.right.map((value) => -value) as unknown as Vec3,
  };
  expectClose(poseOfAxes([3, 2, 1], rolled, 2, [0, 1, 0]).up, normalize(rolled.above), 1e-12);
});
