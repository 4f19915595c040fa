import { describe, expect, test } from 'vitest';
import type { FirstCamera } from './hard-case.ts';
import { cameraFlaws, HardCaseRunner } from './run.ts';

test('leaves no device where the first work on it fails', async () => {
  let held = 0;
  const device = {
    lost: new Promise(() => {}),
    addEventListener: () => {},
    createShaderModule: () => {
      throw new Error('no shaders today');
    },
    destroy: () => held--,
  };
  const requestDevice = async () => {
    held++;
    return device;
  };
  const adapter = { features: new Set(), limits: {}, requestDevice };
  const gpu = { requestAdapter: async () => adapter } as unknown as GPU;
  await expect(HardCaseRunner.create({ gpu })).rejects.toThrow('no shaders today');
  expect(held).toBe(0);
});

const CAMERA: FirstCamera = {
  kind: 'object',
  position: [0.1, -1e7, 1e-20],
  target: [0, 2, 3],
  up: [0, -1, 0],
};

/** The float64 that differs from a number in the last bit alone. */
function withLastBit(value: number): number {
  const float = Float64Array.of(value);
  new BigUint64Array(float.buffer)[0] ^= 1n;
  return float[0];
}

describe('a first camera', () => {
  test('that is the expected one, and has what is expected of it, has no flaws', () => {
    const isNear = { what: 'it is near', holds: ({ target }: FirstCamera) => target[2] < 4 };
    expect(cameraFlaws(CAMERA, [isNear], structuredClone(CAMERA))).toEqual([]);
  });

  for (const member of ['position', 'target', 'up'] as const)
    for (const axis of [0, 1, 2])
      test(`is another one by a bit of ${member}[${axis}]`, () => {
        const values = CAMERA[member].map((value, i) => (i === axis ? withLastBit(value) : value));
        const flaws = cameraFlaws(CAMERA, [], { ...CAMERA, [member]: values });
        expect(flaws).toHaveLength(1);
        expect(flaws[0]).toContain(`${values[axis]}`);
      });

  test('is another one by the sign of a zero, and by its kind', () => {
    expect(cameraFlaws(CAMERA, [], { ...CAMERA, target: [-0, 2, 3] })).toEqual([
      "got { kind: 'object', position: [0.1, -10000000, 1e-20], target: [-0, 2, 3], up: [0, -1, 0] }, " +
        "expected { kind: 'object', position: [0.1, -10000000, 1e-20], target: [0, 2, 3], up: [0, -1, 0] }",
    ]);
    expect(cameraFlaws(CAMERA, [], { ...CAMERA, kind: 'enclosed' })).toHaveLength(1);
  });

  test('that lacks what is expected of it, or is not there, is told so', () => {
    const isFar = { what: 'it is far', holds: () => false };
    expect(cameraFlaws(CAMERA, [isFar], CAMERA)).toEqual(['expected that it is far']);
    expect(cameraFlaws(CAMERA, [isFar], null)).toEqual(['found no camera']);
  });
});
