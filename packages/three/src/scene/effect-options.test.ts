import { volumes } from '@websplatter/core/effects';
import { Box3, Color, Plane, Sphere, Vector3 } from 'three/webgpu';
import { expect, test } from 'vitest';
import { encodedColor, volumeOf } from './effect-options.ts';

// three rounds the exponents of the encoding.
test('colours keep their written values, however three stores them', () => {
  expect(encodedColor('white')).toEqual([1, 1, 1]);
  expect(encodedColor(0x000000)).toEqual([0, 0, 0]);
  const orange = [1, 128 / 255, 0.2];
  for (const color of ['#ff8033', 0xff8033, new Color('#ff8033')])
    encodedColor(color).forEach((value, i) => {
      expect(value).toBeCloseTo(orange[i], 4);
    });
});

test('volumes of shapes keep the side that three would keep', () => {
  const box = new Box3(new Vector3(-1, 0, 2), new Vector3(3, 1, 2.5));
  const sphere = new Sphere(new Vector3(1, 2, 3), 0.5);
  const plane = new Plane(new Vector3(0, 2, 0), -3).normalize();
  const list = [volumeOf(box, 'hide'), volumeOf(sphere), volumeOf(plane)];
  expect(list).toEqual([
    { shape: 'box', mode: 'hide', center: [1, 0.5, 2.25], size: [4, 1, 0.5] },
    { shape: 'sphere', mode: 'keep', center: [1, 2, 3], radius: 0.5 },
    { shape: 'plane', mode: 'keep', point: [0, 1.5, 0], normal: [0, 1, 0] },
  ]);
  // three keeps the side of positive distance.
  expect(plane.distanceToPoint(new Vector3(0, 2, 0))).toBeGreaterThan(0);
  expect(() => volumes(list)).not.toThrow();
});
