import { type CloudInstance, orthographicCamera, perspectiveCamera } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { lookAt, poseFromLookAt } from './orbit-controls.ts';
import {
  boundingSphere,
  boundsOf,
  depthRange,
  firstPose,
  fitDistance,
  flippedMatrix,
  flippedPoint,
  flippedPose,
  orbitNear,
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

  it('turns a cloud where it stands', () => {
    expect(flippedMatrix(undefined)[5]).toBe(-1);
    const moved = [1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 7, 8, 9, 1];
    expect(Array.from(flippedMatrix(moved), (value) => value + 0)).toEqual([
      1, 0, 0, 0, 0, -2, 0, 0, 0, 0, -3, 0, 7, -8, -9, 1,
    ]);
  });

  it('has bounds around all clouds where they stand, but for empty ones', () => {
    const cloud = (count: number, bounds: object) => ({ count, bounds }) as CloudInstance['cloud'];
    const unit = { min: [-1, -1, -1], max: [1, 1, 1] };
    const clouds = [
      { cloud: cloud(2, unit) },
      { cloud: cloud(2, unit), modelMatrix: [0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1] },
      { cloud: cloud(0, { min: [Infinity, 0, 0], max: [-Infinity, 0, 0] }) },
    ];
    expect(boundsOf(clouds, 'bounds')).toEqual({ min: [-1, -2, -1], max: [11, 2, 1] });
    expect(boundsOf([], 'bounds')).toEqual({ min: [0, 0, 0], max: [0, 0, 0] });
  });

  describe('orbit near a camera', () => {
    const view = { position: [3, 1, 4], target: [0, 0, 0], near: 0.1, far: 100 } as const;

    it.each([0.5, 1.6])('is that of a perspective camera at aspect %d', (aspect) => {
      const camera = perspectiveCamera({ ...view, fovYDegrees: 40, aspect });
      const { pose, fovDegrees } = orbitNear(camera, UNIT, aspect);
      expect(verticalFov(fovDegrees, aspect)).toBeCloseTo(40);
      const again = perspectiveCamera({ ...lookAt(pose), fovYDegrees: 40, aspect });
      for (let i = 0; i < 16; i++) expect(again.viewMatrix[i]).toBeCloseTo(camera.viewMatrix[i]);
    });

    it('shows as much as an orthographic camera does at the middle of the scene', () => {
      const camera = orthographicCamera({ ...view, height: 6, aspect: 1.5 });
      const { pose, fovDegrees } = orbitNear(camera, UNIT, 1.5);
      expect(2 * pose.distance * Math.tan((fovDegrees * Math.PI) / 360)).toBeCloseTo(6);
      const { position } = lookAt(pose);
      expect(position[0] / position[2]).toBeCloseTo(3 / 4);
    });

    it('keeps the roll of a camera', () => {
      const camera = perspectiveCamera({ ...view, up: [1, 0, 0], fovYDegrees: 40, aspect: 1 });
      const { pose } = orbitNear(camera, UNIT, 1);
      const again = perspectiveCamera({ ...lookAt(pose), fovYDegrees: 40, aspect: 1 });
      for (let i = 0; i < 16; i++) expect(again.viewMatrix[i]).toBeCloseTo(camera.viewMatrix[i]);
    });

    it('turns to a scene that is behind', () => {
      const camera = perspectiveCamera({ ...view, target: [6, 2, 8], fovYDegrees: 40, aspect: 1 });
      expect(orbitNear(camera, UNIT, 1).pose.target).toEqual([0, 0, 0]);
    });
  });
});
