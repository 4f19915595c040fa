import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { uniform } from '../../testing/uniform.ts';
import { InvalidArgumentError } from '../errors.ts';
import { multiply4 } from '../math/mat4.ts';
import {
  type Camera,
  cameraFromMatrices,
  cameraPosition,
  orthographicCamera,
  perspectiveCamera,
  pixelRay,
  projectionOf,
} from './camera.ts';

const PLACE = { position: [3, -2, 5], target: [0.5, 1, -2], up: [0.1, 1, 0.2], aspect: 1.5 } as const;

/** Pixel of a world-space point, computed from the matrices alone, the textbook way. */
function pixelOf(camera: Camera, point: readonly number[], widthPx: number, heightPx: number): number[] {
  const m = multiply4(camera.projectionMatrix, camera.viewMatrix);
  const [x, y, , w] = [0, 1, 2, 3].map(
    (r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r],
  );
  return [((x / w + 1) / 2) * widthPx, ((1 - y / w) / 2) * heightPx];
}

/** Pixel of a world-space point, computed by `projectionOf`. */
function projectedPixel(
  camera: Camera,
  point: readonly number[],
  widthPx: number,
  heightPx: number,
): number[] {
  const v = camera.viewMatrix;
  const [x, y, z] = [0, 1, 2].map(
    (r) => v[r] * point[0] + v[4 + r] * point[1] + v[8 + r] * point[2] + v[12 + r],
  );
  const { isOrthographic, focalPx, centerPx } = projectionOf(camera, widthPx, heightPx);
  const divisor = isOrthographic ? 1 : -z;
  return [centerPx[0] + (focalPx[0] * x) / divisor, centerPx[1] - (focalPx[1] * y) / divisor];
}

const mirror = Float64Array.of(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
const perspective = perspectiveCamera({ ...PLACE, fovYDegrees: 40 });
const orthographic = orthographicCamera({ ...PLACE, height: 7 });

function shifted(camera: Camera): Camera {
  const projection = Float64Array.from(camera.projectionMatrix);
  const [x, y] = projection[11] === 0 ? [12, 13] : [8, 9];
  projection[x] += 0.3;
  projection[y] -= 0.7;
  return cameraFromMatrices(camera.viewMatrix, projection);
}

const CAMERAS: Readonly<Record<string, Camera>> = {
  perspective,
  orthographic,
  'perspective off-centre': shifted(perspective),
  'orthographic off-centre': shifted(orthographic),
  mirrored: cameraFromMatrices(perspective.viewMatrix, multiply4(mirror, perspective.projectionMatrix)),
};

describe('cameras', () => {
  for (const [name, camera] of Object.entries(CAMERAS)) {
    test(`${name}: projects as its matrices do, anywhere in front of it`, () => {
      const toward = [0, 1, 2].map((axis) => PLACE.target[axis] - PLACE.position[axis]);
      const coordinate = uniform(-1, 1);
      fc.assert(
        fc.property(fc.tuple(coordinate, coordinate, coordinate), (offset) => {
          const point = PLACE.position.map((p, axis) => p + 0.5 * toward[axis] + offset[axis]);
          const expected = pixelOf(camera, point, 300, 200);
          const actual = projectedPixel(camera, point, 300, 200);
          expect(actual[0]).toBeCloseTo(expected[0], 7);
          expect(actual[1]).toBeCloseTo(expected[1], 7);
        }),
      );
    });

    test(`${name}: the ray through a point of the image contains the points seen there, at every depth`, () => {
      fc.assert(
        fc.property(uniform(-50, 350), uniform(-50, 250), uniform(0.01, 1000), (xPx, yPx, depthView) => {
          const { origin, direction } = pixelRay(camera, projectionOf(camera, 300, 200), [xPx, yPx]);
          const point = origin.map((value, axis) => value + depthView * direction[axis]);
          const [x, y] = pixelOf(camera, point, 300, 200);
          expect(x).toBeCloseTo(xPx, 6);
          expect(y).toBeCloseTo(yPx, 6);
          const v = camera.viewMatrix;
          const depth = -(v[2] * point[0] + v[6] * point[1] + v[10] * point[2] + v[14]);
          expect(depth).toBeCloseTo(depthView, 9);
        }),
      );
    });

    test(`${name}: the edges are those of the image, and the Jacobian's clamp lies outside of them`, () => {
      const { edgesX, edgesY, clampX, clampY, focalPx, centerPx } = projectionOf(camera, 300, 200);
      expect(edgesX.map((edge) => centerPx[0] + focalPx[0] * edge)).toEqual([
        expect.closeTo(0, 9),
        expect.closeTo(300, 9),
      ]);
      expect(edgesY.map((edge) => centerPx[1] - focalPx[1] * edge)).toEqual([
        expect.closeTo(200, 9),
        expect.closeTo(0, 9),
      ]);
      for (const [edges, clamp] of [
        [edgesX, clampX],
        [edgesY, clampY],
      ]) {
        const width = Math.abs(edges[1] - edges[0]);
        expect(Math.min(...edges) - clamp[0]).toBeCloseTo(0.15 * width, 9);
        expect(clamp[1] - Math.max(...edges)).toBeCloseTo(0.15 * width, 9);
      }
    });

    test(`${name}: its matrices alone give the same camera`, () => {
      const again = cameraFromMatrices(camera.viewMatrix, camera.projectionMatrix);
      expect(again.near).toBeCloseTo(0.01, 6);
      expect(again.far / 1000).toBeCloseTo(1, 6);
      expect(projectionOf(again, 30, 20).focalPx).toEqual(projectionOf(camera, 30, 20).focalPx);
    });
  }

  test('a part of an image has the clamp of the whole', () => {
    const whole = projectionOf(perspective, 300, 200);
    const half = Float64Array.from(perspective.projectionMatrix);
    for (const column of [0, 4, 8, 12]) half[column] = 2 * half[column] - half[column + 3];
    const camera = { ...perspective, projectionMatrix: half };
    const alone = projectionOf(camera, 150, 200);
    const part = projectionOf({ ...camera, wholeProjectionMatrix: perspective.projectionMatrix }, 150, 200);
    expect(part).toEqual({ ...alone, clampX: whole.clampX, clampY: whole.clampY });
    expect(part.edgesX[1]).toBeCloseTo(whole.edgesX[1], 12);
    expect(alone.clampX[0]).toBeGreaterThan(whole.clampX[0]);
  });

  test('a centred clamp is 1.3 times the tangent of half the field of view', () => {
    const { clampY } = projectionOf(perspective, 300, 200);
    expect(clampY[1]).toBeCloseTo(1.3 * Math.tan((20 * Math.PI) / 180), 12);
  });

  test('stand at their position, with the target in the middle and up upwards', () => {
    for (const camera of [perspective, orthographic]) {
      const position = cameraPosition(camera.viewMatrix);
      for (const axis of [0, 1, 2]) expect(position[axis]).toBeCloseTo(PLACE.position[axis], 12);
      const [x, y] = pixelOf(camera, PLACE.target, 300, 200);
      expect([x, y]).toEqual([expect.closeTo(150, 9), expect.closeTo(100, 9)]);
      const above = PLACE.target.map((t, axis) => t + 0.1 * PLACE.up[axis]);
      expect(pixelOf(camera, above, 300, 200)[1]).toBeLessThan(100);
    }
  });

  test('an infinite far plane is kept, and read from matrices', () => {
    const far = Number.POSITIVE_INFINITY;
    const camera = perspectiveCamera({ ...PLACE, fovYDegrees: 60, near: 0.25, far });
    const again = cameraFromMatrices(camera.viewMatrix, camera.projectionMatrix);
    expect(again).toMatchObject({ near: 0.25, far });
  });

  test('explicit near and far win over the matrix', () => {
    const { viewMatrix, projectionMatrix } = perspective;
    expect(cameraFromMatrices(viewMatrix, projectionMatrix, { near: 1, far: 2 })).toMatchObject({
      near: 1,
      far: 2,
    });
  });

  test('an orthographic camera may look behind itself', () => {
    const camera = orthographicCamera({ ...PLACE, height: 3, near: -5, far: 5 });
    const again = cameraFromMatrices(camera.viewMatrix, camera.projectionMatrix);
    expect(again.near).toBeCloseTo(-5, 9);
    expect(again.far).toBeCloseTo(5, 9);
  });

  test('a ray of a perspective camera begins at the camera, even far from the origin', () => {
    const far = [6.4e6, -3.2e6, 1.7e6] as const;
    const position = PLACE.position.map((value, axis) => value + far[axis]) as [number, number, number];
    const target = PLACE.target.map((value, axis) => value + far[axis]) as [number, number, number];
    const camera = perspectiveCamera({ ...PLACE, position, target, fovYDegrees: 40 });
    const { origin } = pixelRay(camera, projectionOf(camera, 300, 200), [12, 190]);
    for (const axis of [0, 1, 2]) expect(origin[axis]).toBeCloseTo(position[axis], 7);
  });

  test('a singular view matrix has no rays', () => {
    const camera = { ...perspective, viewMatrix: new Float64Array(16) };
    expect(() => pixelRay(camera, projectionOf(camera, 300, 200), [0, 0])).toThrow(InvalidArgumentError);
  });

  test('invalid arguments are rejected by name', () => {
    const make = (changes: object) => () => perspectiveCamera({ ...PLACE, fovYDegrees: 60, ...changes });
    const argumentOf = (run: () => unknown): string => {
      try {
        run();
      } catch (error) {
        expect(error).toBeInstanceOf(InvalidArgumentError);
        return (error as InvalidArgumentError).argument;
      }
      throw new Error('Nothing was thrown.');
    };
    for (const fovYDegrees of [0, 180, -1, Number.NaN])
      expect(argumentOf(make({ fovYDegrees }))).toBe('fovYDegrees');
    for (const aspect of [0, -1, Number.NaN, Number.POSITIVE_INFINITY])
      expect(argumentOf(make({ aspect }))).toBe('aspect');
    for (const near of [0, -1]) expect(argumentOf(make({ near }))).toBe('near');
    for (const far of [0.01, 0, Number.NaN]) expect(argumentOf(make({ far }))).toBe('far');
    expect(argumentOf(make({ near: 1e300, far: Number.POSITIVE_INFINITY }))).toBe('far');
    expect(argumentOf(make({ target: PLACE.position }))).toBe('target');
    expect(argumentOf(make({ position: [0, 5, 0], target: [0, 0, 0], up: [0, 1, 0] }))).toBe('target');
    for (const height of [0, -1, Number.POSITIVE_INFINITY, Number.NaN])
      expect(argumentOf(() => orthographicCamera({ ...PLACE, height }))).toBe('height');
    const { viewMatrix, projectionMatrix } = perspective;
    expect(argumentOf(() => cameraFromMatrices([1, 2, 3], projectionMatrix))).toBe('viewMatrix');
    expect(argumentOf(() => cameraFromMatrices(viewMatrix, Array(16).fill(Number.NaN)))).toBe(
      'projectionMatrix',
    );
    expect(argumentOf(() => cameraFromMatrices(viewMatrix, projectionMatrix, { near: 5, far: 1 }))).toBe(
      'far',
    );
  });
});
