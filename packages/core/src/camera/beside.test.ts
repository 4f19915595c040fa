import { describe, expect, test } from 'vitest';
import { besideOf } from './beside.ts';
import { type Camera, orthographicCamera, perspectiveCamera } from './camera.ts';

const options = { position: [3, 2, 9], target: [0, 1, 0], fovYDegrees: 70, aspect: 1 } as const;
const HEAD = perspectiveCamera({ ...options, near: 0.1, far: 100 });

/** The camera moved in its own space, world units. */
function moved(camera: Camera, x: number, y = 0, back = 0): Camera {
  const viewMatrix = Float64Array.from(camera.viewMatrix);
  viewMatrix[12] -= x;
  viewMatrix[13] -= y;
  viewMatrix[14] -= back;
  return { ...camera, viewMatrix };
}

const offsetOf = (camera: Camera, other = HEAD) => besideOf(camera, other, 100, 80)?.offset ?? null;

describe('besideOf', () => {
  test('tells where a camera that looks the same way is in the view space of another', () => {
    const [x, y] = offsetOf(moved(HEAD, 0.06, -0.02))!;
    expect(x).toBeCloseTo(0.06, 12);
    expect(y).toBeCloseTo(-0.02, 12);
    const ortho = orthographicCamera({ ...options, height: 4 });
    expect(offsetOf(moved(ortho, 0.5), ortho)![0]).toBeCloseTo(0.5, 12);
  });

  test('takes what float32 rounds for the same', () => {
    const right = moved(HEAD, 0.06);
    expect(offsetOf({ ...right, viewMatrix: Float32Array.from(right.viewMatrix) })).not.toBeNull();
  });

  test('is null for cameras that look elsewhere, from another depth, to other depths or with another projection', () => {
    expect(offsetOf(perspectiveCamera({ ...options, target: [0.1, 1, 0], near: 0.1, far: 100 }))).toBeNull();
    expect(offsetOf(moved(HEAD, 0.06, 0, 0.01))).toBeNull();
    expect(offsetOf({ ...HEAD, near: 0.2 })).toBeNull();
    expect(offsetOf({ ...HEAD, far: 90 })).toBeNull();
    expect(offsetOf(orthographicCamera({ ...options, height: 4, near: 0.1, far: 100 }))).toBeNull();
  });
});
