import { describe, expect, it } from 'vitest';
import { lookAt, poseFromLookAt } from './orbit-controls.ts';
import {
  boundingSphere,
  depthRange,
  firstPose,
  fitDistance,
  flippedPoint,
  flippedPose,
  verticalFov,
} from './scene-camera.ts';

const UNIT = { center: [0, 0, 0], radius: 1 } as const;

describe('scene camera', () => {
  it('has a sphere around the bounds, of radius 1 where they are a point', () => {
    expect(boundingSphere({ min: [0, 0, 0], max: [2, 4, 4] })).toEqual({ center: [1, 2, 2], radius: 3 });
    expect(boundingSphere({ min: [5, 5, 5], max: [5, 5, 5] })).toEqual({ center: [5, 5, 5], radius: 1 });
  });

  it('fits the narrower side of the picture', () => {
    expect(fitDistance(1, 60, 2)).toBeCloseTo(2);
    expect(fitDistance(1, 60, 0.5)).toBeGreaterThan(3);
  });

  it('shows the same angle over the shorter side of any picture', () => {
    expect(verticalFov(50, 2)).toBeCloseTo(50);
    expect(verticalFov(90, 0.5)).toBeCloseTo((2 * Math.atan(2) * 180) / Math.PI);
  });

  it('sees all of the scene between its depths', () => {
    const pose = firstPose(UNIT, 50, 1.6);
    const { near, far } = depthRange(pose, UNIT, UNIT);
    expect(near).toBeLessThan(pose.distance - 1);
    expect(far).toBeGreaterThan(pose.distance + 1);
    expect(Math.log2(far / near) % 1).toBe(0);
  });

  it('keeps its depths while the camera turns', () => {
    const pose = firstPose(UNIT, 50, 1);
    const turned = { ...pose, azimuth: pose.azimuth + 1 };
    expect(depthRange(turned, UNIT, UNIT)).toEqual(depthRange(pose, UNIT, UNIT));
  });

  it('faces the same side of a scene that is flipped', () => {
    const pose = poseFromLookAt({ position: [3, 1, 7], target: [1, 2, 3], up: [0, 1, 0] });
    const { position, target } = lookAt(flippedPose(pose));
    // In the scene's own coordinates the camera stays at the same x and z and mirrors its height.
    const inScene = flippedPoint(position);
    expect(flippedPoint(target)).toEqual([1, 2, 3]);
    expect(inScene[0]).toBeCloseTo(3);
    expect(inScene[2]).toBeCloseTo(7);
    expect(inScene[1]).toBeCloseTo(3);
    const twice = lookAt(flippedPose(flippedPose(pose))).position;
    for (const axis of [0, 1, 2]) expect(twice[axis]).toBeCloseTo([3, 1, 7][axis]);
  });
});
