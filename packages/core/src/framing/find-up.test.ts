import { expect, test } from 'vitest';
import { park } from '../testing/made-scene.ts';
import { findSurfaces, findUp } from './find-up.ts';
import { sceneDetail } from './scene-detail.ts';

test('up is the more certain the more flat splats support it, and the usual one is never unlikely', () => {
  const detail = sceneDetail(park().sample())!;
  const surfaces = { ...findSurfaces(detail), best: [0, 0, 1] } as const;
  const confidenceOf = (bestScore: number, by: 'surfaces' | 'convention') =>
    findUp(detail, { ...surfaces, bestScore }, [0, -1, 0], by).confidence;
  // 3 is the score by chance.
  expect([0, 3, 5, 7, 50].map((score) => confidenceOf(score, 'surfaces'))).toEqual([0, 0, 0.5, 1, 1]);
  expect([3, 5, 6, 7].map((score) => confidenceOf(score, 'convention'))).toEqual([0.6, 0.6, 0.75, 1]);
});
