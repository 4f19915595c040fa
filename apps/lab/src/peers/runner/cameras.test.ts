import { describe, expect, test } from 'vitest';
import { BenchError } from './bench-error.ts';
import { camerasAround, parseCameras } from './cameras.ts';

const camera = {
  name: 'front',
  position: [0, 0, 3],
  target: [0, 0, 0],
  up: [0, 1, 0],
  fovYDegrees: 50,
  near: 0.1,
  far: 10,
};

describe('a file of cameras', () => {
  test('is a list; cameras without names get some', () => {
    const { name: _, ...nameless } = camera;
    expect(parseCameras([camera, nameless], 'c.json')).toEqual([camera, { ...camera, name: 'camera-1' }]);
  });

  test.each([
    [camera, /c\.json: it takes a list/],
    [[], /c\.json: it takes a list/],
    [[null], /position of camera 0/],
    [[camera, { ...camera, up: [0, 1] }], /up of camera 1 must be three numbers/],
    [[{ ...camera, fovYDegrees: '50' }], /fovYDegrees of camera 0 must be a number/],
    [[{ ...camera, far: undefined }], /far of camera 0/],
  ])('%j is an error that names file and field', (json, message) => {
    expect(() => parseCameras(json, 'c.json')).toThrow(BenchError);
    expect(() => parseCameras(json, 'c.json')).toThrow(message);
  });
});

test('cameras around a scene stand about its median, in its world, whatever lies far away', () => {
  const count = 101;
  const positions = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) positions[3 * i] = i - 50;
  positions.set([1e6, 1e6, 1e6], 0);
  const cameras = camerasAround({ count, positions, origin: [1000, 0, 0] });
  expect(cameras.map(({ name }) => name)).toEqual(['view-0', 'view-90', 'view-180', 'view-270']);
  for (const { position, target, far } of cameras) {
    expect(Math.abs(target[0] - 1000)).toBeLessThanOrEqual(1);
    const distance = Math.hypot(...position.map((value, axis) => value - target[axis]));
    expect(distance).toBeGreaterThan(50);
    expect(distance).toBeLessThan(200);
    expect(far).toBeGreaterThan(1e6);
  }
});
