import { expect, test } from 'vitest';
import type { VisibleSplat } from '../cull/cull.reference.ts';
import { pickSplat } from './pick.reference.ts';

const CUTOFF = 1 / 255;

/** A round splat with a standard deviation of one pixel around the middle of pixel 2, 1. */
const splatOf = (opacity: number): VisibleSplat => ({
  depthView: 1,
  centerPx: [2.5, 1.5],
  covariance: { a: 1, b: 0, c: 1, determinant: 1 },
  opacity,
  extentPx: [4, 4],
});

test('picks the splat that contributes most, in front or behind', () => {
  expect(pickSplat([splatOf(0.5), splatOf(0.75)], 2, 1, CUTOFF)).toEqual({
    index: 1,
    alpha: 0.75,
    weight: 0.75,
    totalOpacity: 0.875,
    rank: 0,
  });
  expect(pickSplat([splatOf(0.5), splatOf(0.25)], 2, 1, CUTOFF)).toEqual({
    index: 0,
    alpha: 0.5,
    weight: 0.375,
    totalOpacity: 0.625,
    rank: 1,
  });
});

test('picks the foremost of equal contributions', () => {
  // 0.375, and 0.6 of the 0.625 that the first splat lets through.
  const alphaBehind = 0.375 / 0.625;
  expect(alphaBehind * 0.625).toBe(0.375);
  expect(pickSplat([splatOf(alphaBehind), splatOf(0.375)], 2, 1, CUTOFF)?.index).toBe(1);
});

test('opacities fall with the Gaussian, end at the cutoff and are capped', () => {
  const alpha = (opacity: number, xPx: number) => pickSplat([splatOf(opacity)], xPx, 1, CUTOFF)?.alpha;
  expect(alpha(0.5, 3)).toBeCloseTo(0.5 * Math.exp(-0.5), 12);
  expect(alpha(0.5, 5)).toBeCloseTo(0.5 * Math.exp(-4.5), 12);
  expect(alpha(0.5, 6)).toBeUndefined();
  expect(alpha(1, 2)).toBe(0.99);
});

test('picks nothing where there is no splat', () => {
  expect(pickSplat([], 0, 0, CUTOFF)).toBeNull();
  expect(pickSplat([splatOf(1)], 40, 1, CUTOFF)).toBeNull();
});
