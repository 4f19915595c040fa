import { InvalidArgumentError } from '@websplatter/core';
import { Bone, Group } from 'three/webgpu';
import { describe, expect, test } from 'vitest';
import { weightsFromBones } from './weights-from-bones.ts';

/** A chain of bones along y, one unit apart. */
function chain(count: number): Bone[] {
  const bones = Array.from({ length: count }, () => new Bone());
  for (const [i, bone] of bones.entries()) {
    bone.position.y = i === 0 ? 0 : 1;
    bones[i - 1]?.add(bone);
  }
  bones[0].updateMatrixWorld(true);
  return bones;
}

const splatsAt = (positions: number[]) => ({
  positions,
  scales: positions.map(() => 0.1),
  colors: positions.map(() => 1),
});

describe('weights from bones', () => {
  test('are those of the four nearest, the nearest first', () => {
    const { indices, weights } = weightsFromBones(splatsAt([0.1, 4.5, 0, 0.1, 0.5, 0]), chain(6));
    expect(indices[0]).toBe(4);
    // The last one is a point, and the one before reaches up to the fourth.
    expect([...indices.subarray(1, 4)].sort()).toEqual([2, 3, 5]);
    expect(indices[4]).toBe(0);
    expect(weights[0]).toBe(1);
    expect(weights[1]).toBeLessThan(0.01);
  });

  test('are shared alike between bones that are equally near, and fall with the distance to a power', () => {
    const bones = [new Bone(), new Bone()];
    bones[1].position.x = 3;
    for (const bone of bones) bone.updateMatrixWorld();
    const middle = weightsFromBones(splatsAt([1.5, 0, 0]), bones).weights;
    expect(middle[0]).toBeCloseTo(middle[1], 6);
    for (const falloff of [1, 2, 6]) {
      const { indices, weights } = weightsFromBones(splatsAt([1, 0, 0]), bones, { falloff });
      expect([...indices.subarray(0, 2)]).toEqual([0, 1]);
      expect(weights[1] / weights[0]).toBeCloseTo(2 ** -falloff, 6);
      expect([weights[2], weights[3]]).toEqual([0, 0]);
    }
  });

  test('of splats in the space of an object', () => {
    const object = new Group();
    object.position.y = 4;
    const { indices } = weightsFromBones(splatsAt([0, 0.5, 0]), chain(6), { object });
    expect(indices[0]).toBe(4);
  });

  test('at the place of a bone are finite', () => {
    const { weights } = weightsFromBones(splatsAt([0, 0, 0]), [new Bone()]);
    expect([...weights]).toEqual([1, 0, 0, 0]);
  });

  test('need bones, and a falloff above 0', () => {
    expect(() => weightsFromBones(splatsAt([0, 0, 0]), [])).toThrow(/no bones/);
    for (const falloff of [0, Number.NaN, -1, Number.POSITIVE_INFINITY])
      expect(() => weightsFromBones(splatsAt([0, 0, 0]), chain(2), { falloff })).toThrow(
        InvalidArgumentError,
      );
  });
});
