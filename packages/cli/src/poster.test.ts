import { type Camera, cameraFromMatrices, perspectiveCamera, type Vec3 } from '@websplatter/core';
import { expect, test } from 'vitest';
import { posterJsx } from './render.ts';

const ASPECT = 16 / 9;
const BLACK: Vec3 = [0, 0, 0];
const PLACE = { target: [0.5, 1, -2], aspect: ASPECT, fovYDegrees: 40, near: 0.1, far: 50 } as const;
const jsxOf = (camera: Camera, aspect = ASPECT) =>
  posterJsx('out/a.jpg', camera, { cameraFile: 'cam.json', aspect, background: BLACK });

/** Turns a vector about an axis, 0 to 2. */
function turned(vector: readonly number[], axis: number, angle: number): number[] {
  const [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
  const result = [...vector];
  result[b] = Math.cos(angle) * vector[b] - Math.sin(angle) * vector[c];
  result[c] = Math.sin(angle) * vector[b] + Math.cos(angle) * vector[c];
  return result;
}

test.each([
  { position: [3, -2, 5], up: [0.1, 1, 0.2] },
  { position: [-1, 4, -7], up: [0, -1, 0] },
  { position: [0.5, 1, 3], up: [0, 1, 0] },
  // Along x, where angles are not unique.
  { position: [7, 1, -2], up: [0, 0.6, 0.8] },
  { position: [-7, 1, -2], up: [0, 1, 0] },
] as const)('from $position, react-three-fiber makes the same camera', (place) => {
  const camera = perspectiveCamera({ ...PLACE, ...place });
  const props = /position: (\[.*?\]), rotation: (\[.*?\]), fov: (\S+), near: 0.1, far: 50 /.exec(
    jsxOf(camera),
  )!;
  const [position, angles, fov] = props.slice(1).map((text) => JSON.parse(text));
  expect(position).toEqual(place.position.map((value) => expect.closeTo(value, 6)));
  expect(fov).toBe(40);
  // three turns about z first, then y, then x.
  for (const axis of [0, 1, 2]) {
    const own = [0, 1, 2].map((i) => Number(i === axis));
    const world = [2, 1, 0].reduce((vector, about) => turned(vector, about, angles[about]), own);
    const expected = [0, 4, 8].map((column) => expect.closeTo(camera.viewMatrix[column + axis], 5));
    expect(world, `axis ${axis}`).toEqual(expected);
  }
});

test.each([
  ['of another aspect', (p: Float64Array) => (p[0] *= 1.01)],
  ['off its centre', (p: Float64Array) => (p[8] += 0.1)],
  ['mirrored', (p: Float64Array) => (p[5] *= -1)],
] as const)('a camera %s is refused', (_, change) => {
  const camera = perspectiveCamera({ ...PLACE, position: [0, 0, 5] });
  const projection = Float64Array.from(camera.projectionMatrix);
  change(projection);
  const changed = cameraFromMatrices(camera.viewMatrix, projection);
  expect(() => jsxOf(changed)).toThrow(
    'cam.json: --poster needs a camera with which a <SplatCanvas> can begin',
  );
});
