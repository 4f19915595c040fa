import { expect, test } from 'vitest';
import { parseCamera } from './camera-file.ts';

const LOOK_AT = { position: [0, 0, 5], target: [0, 0, 0], up: [0, 1, 0] };
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

test('a perspective camera has its defaults and its field of view', () => {
  const camera = parseCamera({ ...LOOK_AT, fovYDegrees: 90 }, 'cam.json', 2);
  expect(camera.near).toBe(0.01);
  expect(camera.far).toBe(1000);
  expect(camera.projectionMatrix[5]).toBeCloseTo(1, 12);
  expect(camera.projectionMatrix[0]).toBeCloseTo(0.5, 12);
  expect(camera.viewMatrix[14]).toBe(-5);
});

test('an orthographic camera has a height instead', () => {
  const camera = parseCamera(
    { ...LOOK_AT, projection: 'orthographic', height: 4, near: 1, far: 9 },
    'cam.json',
    1,
  );
  expect(camera.projectionMatrix[5]).toBe(0.5);
  expect(camera.projectionMatrix[11]).toBe(0);
  expect([camera.near, camera.far]).toEqual([1, 9]);
});

test('a camera may be two matrices, with near and far read from the projection', () => {
  const { projectionMatrix } = parseCamera(
    { ...LOOK_AT, fovYDegrees: 60, near: 0.5, far: 50 },
    'cam.json',
    1,
  );
  const camera = parseCamera(
    { viewMatrix: IDENTITY, projectionMatrix: [...Array.from(projectionMatrix)] },
    'cam.json',
    1,
  );
  expect(camera.near).toBeCloseTo(0.5, 9);
  expect(camera.far).toBeCloseTo(50, 6);
});

/** Lists in lists. */
const nested = (depth: number) => JSON.parse('['.repeat(depth) + ']'.repeat(depth));

/**
 * @fault Arguments: a camera or matrix for the command line with any value or depth
 * @consequence the message names the field, and shows the beginning of the value
 */
test.each([
  [[], 'cam.json: a camera is an object, found []'],
  [{ target: [0, 0, 0] }, 'cam.json: position must be 3 finite numbers, found nothing (field position)'],
  [{ ...LOOK_AT, up: [0, '1', 0] }, 'cam.json: up must be 3 finite numbers, found [0, "1", 0] (field up)'],
  [LOOK_AT, 'cam.json: fovYDegrees must be a finite number, found nothing (field fovYDegrees)'],
  [{ ...LOOK_AT, fovYDegrees: 200 }, /^cam\.json: fovYDegrees is 200; .*\(field fovYDegrees\)$/],
  [{ ...LOOK_AT, fovYDegrees: 60, near: 5, far: 2 }, /^cam\.json: near is 5 and far is 2; .*\(field far\)$/],
  [{ ...LOOK_AT, fovYDegrees: 60, up: [0, 0, 1] }, /^cam\.json: The camera has no direction: up is parallel/],
  [
    { ...LOOK_AT, projection: 'fisheye' },
    /^cam\.json: projection must be .*found "fisheye" \(field projection\)$/,
  ],
  [{ ...LOOK_AT, projection: 'orthographic' }, /^cam\.json: height must be a finite number, found nothing/],
  [{ viewMatrix: IDENTITY }, /^cam\.json: projectionMatrix must be 16 finite numbers, found nothing/],
  [{ ...LOOK_AT, up: nested(5000) }, /^cam\.json: up must be 3 finite numbers, found \[{80}… \(field up\)$/],
  [nested(5000), /^cam\.json: a camera is an object, found \[{80}…$/],
])('camera %# is refused with the file and the field', (json, message) => {
  expect(() => parseCamera(json, 'cam.json', 1)).toThrow(message);
});
