import { expect, test } from 'vitest';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { cropSplats } from '../../data/editing/crop-splats.ts';
import { mergeSplats } from '../../data/editing/merge-splats.ts';
import { transformSplats } from '../../data/editing/transform-splats.ts';
import { dropNonFinite } from '../../data/packing/drop-non-finite.ts';
import { opacityOf } from '../../data/splats/color-values.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { movingSplats } from '../../testing/moving-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { SplatMorph } from '../morph/splat-morph.data.ts';
import { MOTION_SLOT, MOTION_VALUES } from './splat-motion.data.ts';
import { splatsAt } from './splats-at.data.ts';

const SET = movingSplats({ count: 200, seed: 3, shDegree: 1 });

/** The splats of Spacetime Gaussians at a time, by the formulas of their paper. */
function expectedAt({ motion, ...set }: typeof SET, time: number): SplatSet {
  const at = (i: number, slot: number) => motion[i * MOTION_VALUES + slot];
  const positions = set.positions.slice();
  const rotations = set.rotations.slice();
  const opacityLogits = set.opacityLogits.slice();
  for (let i = 0; i < set.count; i++) {
    const d = time - at(i, 0);
    for (let k = 0; k < 3; k++)
      positions[3 * i + k] += at(i, 2 + k) * d + at(i, 5 + k) * d ** 2 + at(i, 8 + k) * d ** 3;
    for (let k = 0; k < 4; k++) rotations[4 * i + k] += at(i, 11 + k) * d;
    const opacity = Math.exp(-((d / Math.exp(at(i, 1))) ** 2)) / (1 + Math.exp(-opacityLogits[i]));
    opacityLogits[i] = Math.log(opacity / (1 - opacity));
  }
  return { ...set, positions, rotations, opacityLogits };
}

function expectAlike(got: SplatSet, expected: SplatSet, digits: number) {
  for (const name of ['positions', 'rotations', 'opacityLogits'] as const) {
    expect(got[name]).toHaveLength(expected[name].length);
    for (const [i, value] of got[name].entries()) expect(value).toBeCloseTo(expected[name][i], digits);
  }
}

test.each([0, 0.25, 0.5, 1, 1.5])('freezes a moving scene at %s', (time) => {
  const frozen = splatsAt(SET, time) as SplatSet;
  const expected = expectedAt(SET, time);
  const visible = Array.from({ length: SET.count }, (_, i) => i).filter(
    (i) => opacityOf(expected.opacityLogits[i]) >= 1 / 4096,
  );
  expect([...frozen.fileIndices]).toEqual(visible);
  expect(visible.length).toBeLessThan(SET.count);
  const width = (name: 'positions' | 'rotations' | 'opacityLogits') =>
    ({ positions: 3, rotations: 4, opacityLogits: 1 })[name];
  for (const name of ['positions', 'rotations', 'opacityLogits'] as const)
    visible.forEach((row, i) => {
      const n = width(name);
      for (let k = 0; k < n; k++) expect(frozen[name][n * i + k]).toBeCloseTo(expected[name][n * row + k], 4);
    });
  expect(frozen.motion).toBeUndefined();
});

test('leaves splats that stand still as they are', () => {
  const set = randomSplats({ count: 5 });
  expect(splatsAt(set, 0.5)).toBe(set);
  expect(() => splatsAt(SET, Number.NaN)).toThrow(/time is NaN.*a finite number/);
});

test('moving a moving scene is as moving each of its moments', () => {
  const transform = { rotation: [1, 2, -1, 0.5], scale: 1.5, translation: [1, -2, 3] } as const;
  const moved = transformSplats(SET, transform) as SplatSet;
  for (const time of [0.1, 0.8]) {
    const first = splatsAt(moved, time) as SplatSet;
    const then = transformSplats(splatsAt(SET, time), transform) as SplatSet;
    expectAlike(first, then, 4);
  }
});

test('merging keeps splats of other sets in place, cropping keeps motions', () => {
  const still = randomSplats({ count: 20, seed: 9, shDegree: 1, opacityLogits: [0, 4] });
  const merged = mergeSplats([SET, still]);
  const at = splatsAt(merged, 0.9) as SplatSet;
  const last = at.count - still.count;
  expect(at.positions.subarray(3 * last)).toEqual(still.positions);
  expect(at.rotations.subarray(4 * last)).toEqual(still.rotations);
  for (const [i, value] of still.opacityLogits.entries())
    expect(at.opacityLogits[last + i]).toBeCloseTo(value, 5);
  const cropped = cropSplats(SET, { min: [0, -2, -2], max: [2, 2, 2] });
  const [row] = cropped.fileIndices;
  expect(cropped.motion!.subarray(0, MOTION_VALUES)).toEqual(
    SET.motion.subarray(row * MOTION_VALUES, (row + 1) * MOTION_VALUES),
  );
});

test('drops splats whose motion is not finite or too fast', () => {
  const motion = SET.motion.slice();
  motion[MOTION_SLOT.jerk] = Number.NaN;
  motion[MOTION_VALUES + MOTION_SLOT.time] = Number.POSITIVE_INFINITY;
  motion[2 * MOTION_VALUES + MOTION_SLOT.turn] = 1e13;
  const kept = dropNonFinite({ ...SET, motion });
  expect(kept.dropped).toEqual({ 'non-finite-motion': 3 });
  expect(kept.motion).toHaveLength((SET.count - 3) * MOTION_VALUES);
});

test('what holds no motion refuses moving scenes', () => {
  expect(() => brickSceneOf(SET)).toThrow(
    /These splats move, and a scene in bricks holds only splats that stand still/,
  );
  expect(() => new SplatMorph(SET, SET, { geometryPrecision: 'f32', shPrecision: 'f32' })).toThrow(
    /These splats move, and a morph/,
  );
});
