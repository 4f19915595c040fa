import { expect, test } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { worldBounds } from './world-bounds.ts';

const cloud = { count: 1, robustBounds: { min: [0, 0, 0], max: [1, 2, 3] } } as unknown as SplatCloud;
const empty = { ...cloud, count: 0 } as SplatCloud;

test('bounds of several clouds are those of all their corners in the world', () => {
  expect(worldBounds([{ cloud }])).toEqual(cloud.robustBounds);
  // A quarter turn about z, then moved by 10 along x.
  const modelMatrix = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1];
  expect(worldBounds([{ cloud, modelMatrix }])).toEqual({ min: [8, 0, 0], max: [10, 1, 3] });
  expect(worldBounds([{ cloud, modelMatrix }, { cloud }])).toEqual({ min: [0, 0, 0], max: [10, 2, 3] });
});

test('a cloud without splats is ignored', () => {
  expect(worldBounds([{ cloud }, { cloud: empty, modelMatrix: Array(16).fill(7) }])).toEqual(
    cloud.robustBounds,
  );
  expect(worldBounds([{ cloud: empty }])).toEqual({ min: [0, 0, 0], max: [0, 0, 0] });
});
