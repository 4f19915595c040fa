import { describe, expect, it } from 'vitest';
import { lookAt, poseFromLookAt } from '../state/orbit-pose.ts';
import { dot, scale, subtract, type Vec3 } from '../state/vec3.ts';
import { flippedMatrix, flippedPoint, flippedPose } from './flip.ts';

describe('flip', () => {
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

  it('faces the same side of a scene whose z axis points up', () => {
    const pose = poseFromLookAt({ position: [3, 1, 7], target: [1, 2, 3], up: [0, 0, 1] });
    const inScene = flippedPoint(lookAt(flippedPose(pose)).position);
    expect(inScene[0]).toBeCloseTo(3);
    expect(inScene[1]).toBeCloseTo(1);
    // Mirrored in height around the target.
    expect(inScene[2]).toBeCloseTo(-1);
  });

  it('faces the same side of a tilted scene, whose up is then exactly the opposite', () => {
    const up = [0.48, 0.6, 0.64] as const;
    const pose = poseFromLookAt({ position: [3, 1, 7], target: [1, 2, 3], up });
    const before = lookAt(pose);
    const after = lookAt(flippedPose(pose));
    const height = (point: Vec3) => dot(subtract(point, [1, 2, 3]), up);
    const level = (point: Vec3) => subtract(point, scale(up, height(point)));
    const inScene = flippedPoint(after.position);
    expect(height(inScene)).toBeCloseTo(-height(before.position));
    for (const axis of [0, 1, 2]) {
      expect(flippedPoint(after.up)[axis]).toBeCloseTo(-up[axis]);
      expect(level(inScene)[axis]).toBeCloseTo(level(before.position)[axis]);
    }
  });

  it('turns a cloud where it stands', () => {
    expect(flippedMatrix(undefined)[5]).toBe(-1);
    const moved = [1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 7, 8, 9, 1];
    expect(Array.from(flippedMatrix(moved), (value) => value + 0)).toEqual([
      1, 0, 0, 0, 0, -2, 0, 0, 0, 0, -3, 0, 7, -8, -9, 1,
    ]);
  });
});
