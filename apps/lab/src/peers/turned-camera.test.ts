import { expect, test } from 'vitest';
import { turnedCamera } from './turned-camera.ts';

const camera = {
  name: 'front',
  position: [1, 4, 5],
  target: [1, 2, 3],
  up: [0, 2, 0],
  fovYDegrees: 50,
  near: 0.1,
  far: 10,
} as const;

test('a camera turns about the axis up through its target, counterclockwise seen from above', () => {
  const { position, ...others } = turnedCamera(camera, Math.PI / 2);
  for (const [axis, value] of [3, 4, 3].entries()) expect(position[axis]).toBeCloseTo(value, 12);
  const { position: _, ...unchanged } = camera;
  expect(others).toEqual(unchanged);
});

test('it keeps its distance about a slanted axis, and a whole turn leads back', () => {
  const slanted = { ...camera, up: [1, 1, 0.5] as const };
  const distance = (to: readonly number[]) =>
    Math.hypot(...to.map((value, axis) => value - camera.target[axis]));
  expect(distance(turnedCamera(slanted, 1).position)).toBeCloseTo(distance(camera.position), 12);
  const { position } = turnedCamera(slanted, 2 * Math.PI);
  for (const [axis, value] of camera.position.entries()) expect(position[axis]).toBeCloseTo(value, 12);
});
