import { cameraPosition, type SplatCloud } from '@websplatter/core';
import { expect, test } from 'vitest';
import { cameraAround } from './scene.ts';

/** A cloud of one shape. */
function cloudOf(half: readonly [number, number, number], format: string): SplatCloud {
  const bounds = { min: half.map((value) => -value), max: half };
  return { bounds, robustBounds: bounds, facts: { fileFacts: { format } } } as unknown as SplatCloud;
}

const positionOf = (cloud: SplatCloud, aspect = 2) => cameraPosition(cameraAround(cloud, aspect).viewMatrix);

test('a scene without cameras is seen whole, in the image’s shape', () => {
  const camera = cameraAround(cloudOf([1, 1, 1], 'ply'), 2);
  expect(Math.hypot(...cameraPosition(camera.viewMatrix))).toBeGreaterThan(Math.sqrt(3));
  expect(camera.projectionMatrix[5] / camera.projectionMatrix[0]).toBeCloseTo(2, 12);
  const upright = cameraAround(cloudOf([1, 1, 1], 'ply'), 0.5);
  expect(upright.projectionMatrix[0]).toBeCloseTo(camera.projectionMatrix[5], 12);
});

test('a capture is seen with y down, glTF with y up, and a survey of ground with z up', () => {
  expect(positionOf(cloudOf([1, 1, 1], 'ply'))[1]).toBeLessThan(0);
  expect(positionOf(cloudOf([1, 1, 1], 'gltf'))[1]).toBeGreaterThan(0);
  // Captures with y down are seen from −x.
  const isZUp = (...half: [number, number, number]) => positionOf(cloudOf(half, 'ply'))[0] > 0;
  expect(isZUp(9, 9, 1)).toBe(true);
  // Boxes, walls and pictures without depth are no ground.
  const others: [number, number, number][] = [
    [10, 9, 8],
    [100, 10, 100],
    [100, 20, 2],
    [10, 10, 0],
  ];
  for (const half of others) expect(isZUp(...half)).toBe(false);
});
