import { expect, it } from 'vitest';
import { numberOfShares } from './scene-shares.ts';

it.each([
  [150_000, 16, 10],
  [150_000, 8, 7],
  [150_000, 2, 1],
  [150_000, 1, 1],
  [10_000, 16, 1],
])('makes %i splats on %i processors in %i shares', (splats, processors, shares) => {
  expect(numberOfShares(splats, processors)).toBe(shares);
});
