import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../data/errors.ts';
import { identity4 } from '../../data/math/mat4.ts';
import { type SkinWeights, SplatSkin } from './splat-skin.data.ts';

const ONE: SkinWeights = { indices: [0, 0, 0, 0], weights: [1, 0, 0, 0] };
const moved = (x: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1];

const bytesOf = (word: number) => [0, 8, 16, 24].map((shift) => (word >>> shift) & 255);

describe('a skin', () => {
  test('keeps four joints and weights in 8 bytes per row', () => {
    const { words, rowCount } = new SplatSkin(
      { indices: [3, 1, 0, 2, 0, 0, 0, 255], weights: [2, 1, 0, 1, 0, 0, 0, 0.001] },
      256,
    );
    expect(rowCount).toBe(2);
    expect(words.byteLength).toBe(16);
    expect(bytesOf(words[0])).toEqual([3, 1, 0, 2]);
    // 127.5, 63.75 and 63.75: the largest remainders are rounded up.
    expect(bytesOf(words[1])).toEqual([127, 64, 0, 64]);
    expect([bytesOf(words[2]), bytesOf(words[3])]).toEqual([
      [0, 0, 0, 255],
      [0, 0, 0, 255],
    ]);
  });

  test('has weights that sum up to 1 and are within a step of the given ones', () => {
    const weight = fc.float({ min: 0, max: 1e6, noNaN: true });
    fc.assert(
      fc.property(fc.tuple(weight, weight, weight, weight), (weights) => {
        const total = weights.reduce((sum, value) => sum + value, 0);
        fc.pre(total > 0);
        const steps = bytesOf(new SplatSkin({ indices: [0, 0, 0, 0], weights }, 1).words[1]);
        expect(steps.reduce((sum, value) => sum + value, 0)).toBe(255);
        for (const [k, step] of steps.entries())
          expect(Math.abs(step - (255 * weights[k]) / total)).toBeLessThan(1);
      }),
    );
  });

  test('moves points by the mean of its joints', () => {
    const skin = new SplatSkin({ indices: [0, 1, 0, 0], weights: [2, 3, 0, 0] }, 2);
    expect(skin.moved(0, [1, 2, 3])).toEqual([1, 2, 3]);
    skin.setPose([...moved(0), ...moved(5)]);
    expect(skin.moved(0, [1, 2, 3])[0]).toBeCloseTo(4, 12);
  });

  test('tells whether a pose is another one', () => {
    const skin = new SplatSkin(ONE, 1);
    expect(skin.setPose(identity4())).toBe(false);
    expect(skin.version).toBe(0);
    expect(skin.setPose(moved(1))).toBe(true);
    expect(skin.setPose(new Float32Array(moved(1)))).toBe(false);
    expect(skin.version).toBe(1);
  });

  test('keeps its pose where the caller changes the list', () => {
    const skin = new SplatSkin(ONE, 1);
    const pose = moved(1);
    skin.setPose(pose);
    pose[12] = 7;
    expect(skin.moved(0, [0, 0, 0])).toEqual([1, 0, 0]);
  });

  const refused: Readonly<Record<string, readonly [SkinWeights, number, RegExp]>> = {
    'no joints': [ONE, 0, /^jointCount is 0; .* 1 to 256/],
    'too many joints': [ONE, 257, /^jointCount is 257/],
    'a joint that there is not': [
      { indices: [0, 0, 0, 0, 0, 2, 0, 0], weights: [1, 0, 0, 0, 1, 0, 0, 0] },
      2,
      /^indices\[5\] is 2; it must be a joint of row 1: a whole number below 2/,
    ],
    'half a joint': [{ ...ONE, indices: [0.5, 0, 0, 0] }, 2, /^indices\[0\] is 0.5/],
    'a row without weights': [{ ...ONE, weights: [0, 0, 0, 0] }, 1, /^Row 0 has no joint/],
    'a weight that float32 cannot hold': [
      { ...ONE, weights: [1, 1e300, 0, 0] },
      1,
      /^weights\[1\] is 1e\+300/,
    ],
    'a weight that is no number': [{ ...ONE, weights: [1, Number.NaN, 0, 0] }, 1, /^weights\[1\] is NaN/],
    'a negative weight': [{ ...ONE, weights: [2, -1, 0, 0] }, 1, /^weights\[1\] is -1; .*row 0/],
    'fewer weights than joints': [{ ...ONE, weights: [1] }, 1, /^indices has 4 numbers and weights has 1/],
    'three of a row': [{ indices: [0, 0, 0], weights: [1, 0, 0] }, 1, /^indices has 3 .*four for each row/],
    'no list': [{ ...ONE, weights: 1 as unknown as number[] }, 1, /^weights is 1/],
  };
  for (const [what, [weights, count, message]] of Object.entries(refused))
    test(`refuses ${what}`, () => {
      expect(() => new SplatSkin(weights, count)).toThrow(InvalidArgumentError);
      expect(() => new SplatSkin(weights, count)).toThrow(message);
    });

  test('refuses poses of other lengths and numbers, and keeps its own', () => {
    const skin = new SplatSkin(ONE, 2);
    expect(() => skin.setPose(moved(1))).toThrow(/^matrices has 16 numbers; 2 joints have 32/);
    const broken = [...moved(1), ...moved(Number.NaN)];
    expect(() => skin.setPose(broken)).toThrow(/^matrices\[28\] is NaN; .*joint 1/);
    expect(() => skin.setPose([...moved(1), ...moved(1e300)])).toThrow(
      /^matrices\[28\] is 1e\+300; .*joint 1/,
    );
    expect(() => skin.setPose(broken)).toThrow(InvalidArgumentError);
    expect(skin.version).toBe(0);
  });
});
