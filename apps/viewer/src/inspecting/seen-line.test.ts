import { orthographicCamera, perspectiveCamera } from '@websplatter/core';
import { expect, it } from 'vitest';
import { boxEdges, seenLine, seenPoint } from './seen-line.ts';

const box = { width: 200, height: 100 };
const camera = perspectiveCamera({
  position: [0, 0, 10],
  target: [0, 0, 0],
  aspect: 2,
  fovYDegrees: 90,
  near: 1,
  far: 100,
});

it('a point is seen where its splat would be drawn', () => {
  expect(seenPoint(camera, box, [0, 0, 0])).toEqual([100, 50]);
  // A tenth of the half height above the middle, at the distance where that is 10 units.
  const [x, y] = seenPoint(camera, box, [5, 1, 0])!;
  expect(x).toBeCloseTo(125, 9);
  expect(y).toBeCloseTo(45, 9);
});

it('a line that passes the camera ends at the near plane, at either end', () => {
  const whole = seenLine(camera, box, [1, 0, 0], [1, 0, 9]);
  const cut = seenLine(camera, box, [1, 0, 0], [1, 0, 30]);
  expect(whole![1][0]).toBeCloseTo(150, 9);
  expect(cut![1][0]).toBeCloseTo(150, 9);
  expect(seenLine(camera, box, [1, 0, 30], [1, 0, 0])![0][0]).toBeCloseTo(150, 9);
});

it('a point or a line behind the camera is not seen', () => {
  expect(seenPoint(camera, box, [0, 0, 9.5])).toBeNull();
  expect(seenLine(camera, box, [0, 0, 11], [5, 5, 12])).toBeNull();
});

it('a parallel projection has no vanishing point', () => {
  const parallel = orthographicCamera({ position: [0, 0, 10], target: [0, 0, 0], aspect: 2, height: 10 });
  expect(seenPoint(parallel, box, [2, 1, 0])).toEqual(seenPoint(parallel, box, [2, 1, -50]));
});

it('a box has twelve edges, each along one axis', () => {
  const edges = boxEdges({ min: [0, 1, 2], max: [10, 11, 12] });
  expect(new Set(edges.map(String)).size).toBe(12);
  for (const [from, to] of edges)
    expect(to.map((value, axis) => value - from[axis]).toSorted()).toEqual([0, 0, 10]);
});
