import { describe, expect, test } from 'vitest';
import { identity4 } from '../math/mat4.ts';
import { cameraFromMatrices } from './camera.ts';
import { storedDepth } from './depth-convention.ts';

const NEAR = 0.5;
const FAR = 20;

/** Column-major; off-centre, clip depth 0…1. */
const PERSPECTIVE = [
  1.5,
  0,
  0,
  0,
  0,
  2,
  0,
  0,
  0.2,
  -0.1,
  -FAR / (FAR - NEAR),
  -1,
  0,
  0,
  -(FAR * NEAR) / (FAR - NEAR),
  0,
];
const ORTHOGRAPHIC = [
  0.5,
  0,
  0,
  0,
  0,
  0.4,
  0,
  0,
  0,
  0,
  -1 / (FAR - NEAR),
  0,
  0.1,
  0.3,
  -NEAR / (FAR - NEAR),
  1,
];

/** That projection with a near plane that is not perpendicular to the line of sight. */
function withObliquePlane(projection: readonly number[], plane: readonly number[]): number[] {
  const oblique = [...projection];
  plane.forEach((value, column) => {
    oblique[4 * column + 2] = value;
  });
  return oblique;
}

const projections: Record<string, readonly number[]> = {
  perspective: PERSPECTIVE,
  'reversed perspective': withObliquePlane(PERSPECTIVE, [
    0,
    0,
    NEAR / (FAR - NEAR),
    (FAR * NEAR) / (FAR - NEAR),
  ]),
  'oblique perspective': withObliquePlane(PERSPECTIVE, [0.3, -0.2, -0.9, -0.6]),
  orthographic: ORTHOGRAPHIC,
  'oblique orthographic': withObliquePlane(ORTHOGRAPHIC, [0.1, 0.05, -0.06, -0.04]),
};

describe('stored depth', () => {
  test.each(Object.keys(projections))('of a %s projection equals that of the matrix', (name) => {
    const p = projections[name];
    const camera = cameraFromMatrices(identity4(), p, { near: NEAR, far: FAR });
    for (const [x, y, depthView] of [
      [0, 0, 1],
      [0.3, -0.4, 2],
      [-2, 1, 7],
      [1, 3, 19],
    ]) {
      const [clipX, clipY, clipZ, clipW] = [0, 1, 2, 3].map(
        (row) => p[row] * x + p[4 + row] * y - p[8 + row] * depthView + p[12 + row],
      );
      const stored = storedDepth(depthView, camera, 'projection', [clipX / clipW, clipY / clipW]);
      expect(stored).toBeCloseTo(clipZ / clipW, 12);
    }
  });

  test('stays within 0…1 if the near plane is perpendicular to the line of sight', () => {
    const camera = cameraFromMatrices(identity4(), PERSPECTIVE, { near: NEAR, far: FAR });
    expect(storedDepth(NEAR * (1 - 1e-9), camera, 'projection')).toBe(0);
    expect(storedDepth(FAR * (1 + 1e-9), camera, 'projection')).toBe(1);
  });

  test('of points in front of an oblique near plane is outside of 0…1, so that they are clipped', () => {
    const oblique = withObliquePlane(PERSPECTIVE, [0, 0.5, -1, -4]);
    const camera = cameraFromMatrices(identity4(), oblique, { near: NEAR, far: FAR });
    expect(storedDepth(2, camera, 'projection')).toBeLessThan(0);
  });

  test('is logarithmic from 0 at the near plane to 1 at the far plane', () => {
    const camera = cameraFromMatrices(identity4(), PERSPECTIVE, { near: NEAR, far: FAR });
    expect(storedDepth(NEAR, camera, 'logarithmic')).toBeCloseTo(0, 12);
    expect(storedDepth(Math.sqrt(NEAR * FAR), camera, 'logarithmic')).toBeCloseTo(0.5, 12);
    expect(storedDepth(FAR, camera, 'logarithmic')).toBeCloseTo(1, 12);
  });

  test('is linear from the near plane to the far plane of an orthographic camera, logarithmic or not', () => {
    const camera = cameraFromMatrices(identity4(), ORTHOGRAPHIC, { near: NEAR, far: FAR });
    expect(storedDepth(NEAR, camera, 'logarithmic')).toBeCloseTo(0, 12);
    expect(storedDepth((NEAR + FAR) / 2, camera, 'logarithmic')).toBeCloseTo(0.5, 12);
    expect(storedDepth(FAR, camera, 'logarithmic')).toBeCloseTo(1, 12);
  });
});
