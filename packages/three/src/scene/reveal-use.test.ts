import type { RevealOptions } from '@websplatter/core/effects';
import { Box3, PerspectiveCamera, Vector3 } from 'three/webgpu';
import { expect, test } from 'vitest';
import type { RevealAnimation } from './reveal-animation.ts';
import { revealUse } from './scene-effects.ts';

const bounds = new Box3(new Vector3(-1, -1, -1), new Vector3(3, 3, 1));
const camera = new PerspectiveCamera();

function optionsAt(animation: RevealAnimation, progress: number, of = bounds): RevealOptions {
  return revealUse(animation, progress, of, camera).options as RevealOptions;
}

test('reaches the farthest corner and its soft edge', () => {
  const animation = { from: [0, 0, 0], durationMs: 1000, softEdge: 0.5, grow: false } as const;
  expect(optionsAt(animation, 0)).toEqual({ from: [0, 0, 0], radius: 0, softEdge: 0.5, grow: false });
  const end = Math.hypot(3, 3, 1) + 0.5;
  for (const progress of [0.25, 0.9])
    expect(optionsAt(animation, progress).radius).toBeCloseTo(progress ** 3 * end, 12);
});

test('reaches the corner farthest from the camera, with an edge that grows with the radius', () => {
  const animation = { from: 'camera', durationMs: 100 } as const;
  camera.position.set(0, 0, 10);
  camera.updateMatrixWorld();
  const [half, last] = [0.5, 1].map((progress) => optionsAt(animation, progress));
  expect(half.radius).toBeCloseTo(last.radius / 8, 9);
  expect(half.softEdge! / half.radius).toBeCloseTo(last.softEdge! / last.radius, 9);
  expect(last.softEdge! / last.radius).toBeGreaterThan(0.1);
  expect(last.radius - last.softEdge!).toBeCloseTo(Math.hypot(3, 3, 11), 6);
});

test.each<RevealAnimation>([
  { from: 'camera', durationMs: 100 },
  { from: [0, 0, 0], durationMs: 100, softEdge: 1 },
])('stays small for a cloud without splats: %o', (animation) => {
  for (const progress of [0, 0.5])
    expect(optionsAt(animation, progress, new Box3()).radius).toBeLessThanOrEqual(1);
});
