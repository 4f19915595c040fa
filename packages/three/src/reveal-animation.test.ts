import { InvalidArgumentError } from '@websplatter/core';
import type { RevealOptions } from '@websplatter/core/effects';
import { Box3, PerspectiveCamera, Vector3 } from 'three/webgpu';
import { expect, test } from 'vitest';
import { type RevealAnimation, Revealing } from './reveal-animation.ts';

const bounds = new Box3(new Vector3(-1, -1, -1), new Vector3(3, 3, 1));
const camera = new PerspectiveCamera();

function optionsAt(revealing: Revealing, nowMs: number): RevealOptions {
  return revealing.useAt(nowMs, bounds, camera).options as RevealOptions;
}

test('begins with the first frame, and reaches the farthest corner and its soft edge', () => {
  const revealing = new Revealing({ from: [0, 0, 0], durationMs: 1000, softEdge: 0.5, grow: false });
  expect(optionsAt(revealing, 300)).toEqual({ from: [0, 0, 0], radius: 0, softEdge: 0.5, grow: false });
  revealing.begin(500);
  revealing.begin(700);
  const end = Math.hypot(3, 3, 1) + 0.5;
  for (const progress of [0, 0.25, 0.9]) {
    expect(optionsAt(revealing, 500 + 1000 * progress).radius).toBeCloseTo(progress ** 3 * end, 12);
    expect(revealing.isOver(500 + 1000 * progress)).toBe(false);
  }
  expect(revealing.isOver(1500)).toBe(true);
  // The effect is off now.
  expect(revealing.useAt(1500, bounds, camera).reason).toBeNull();
});

test('reaches the corner farthest from the camera, with an edge that grows with the radius', () => {
  const revealing = new Revealing({ from: 'camera', durationMs: 100 });
  camera.position.set(0, 0, 10);
  camera.updateMatrixWorld();
  revealing.begin(0);
  const [half, last] = [50, 100 - 1e-9].map((nowMs) => optionsAt(revealing, nowMs));
  expect(half.radius).toBeCloseTo(last.radius / 8, 9);
  expect(half.softEdge! / half.radius).toBeCloseTo(last.softEdge! / last.radius, 9);
  expect(last.softEdge! / last.radius).toBeGreaterThan(0.1);
  expect(last.radius - last.softEdge!).toBeCloseTo(Math.hypot(3, 3, 11), 6);
});

test.each<RevealAnimation>([
  { from: 'camera', durationMs: 100 },
  { from: [0, 0, 0], durationMs: 100, softEdge: 1 },
])('stays small for a cloud without splats, and ends: %o', (animation) => {
  const revealing = new Revealing(animation);
  revealing.begin(0);
  for (const nowMs of [0, 50]) {
    const { options } = revealing.useAt(nowMs, new Box3(), camera);
    expect((options as RevealOptions).radius).toBeLessThanOrEqual(1);
  }
  expect(revealing.isOver(100)).toBe(true);
});

test.each<[string, Partial<RevealAnimation>]>([
  ['durationMs', { durationMs: 0 }],
  ['durationMs', { durationMs: Number.POSITIVE_INFINITY }],
  ['durationMs', { durationMs: Number.NaN }],
  ['from', { from: [0, 1, Number.NaN] }],
  ['softEdge', { softEdge: -1 }],
  // Of a reveal without a time.
  ['reveal', { radius: 3 } as never],
])('rejects an invalid %s', (argument, options) => {
  const make = () => new Revealing({ from: 'camera', durationMs: 1, ...options });
  expect(make).toThrow(InvalidArgumentError);
  expect(make).toThrow(expect.objectContaining({ argument }));
});
