import { describe, expect, test } from 'vitest';
import { centerBounds } from './center-bounds.ts';
import { chooseOrigin } from './origin.ts';
import { PositionSample, sampledRows } from './position-sample.ts';

/** A scene of 3 m, as doubles, around a point. */
function sceneAt(centre: readonly number[], count = 300): number[][] {
  return Array.from({ length: count }, (_, i) =>
    centre.map((value, axis) => value + 3 * (((i * [0.618, 0.754, 0.569][axis]) % 1) - 0.5)),
  );
}

function originOf(points: readonly (readonly number[])[], isWide = true) {
  const positions = isWide ? Float64Array.from(points.flat()) : Float32Array.from(points.flat());
  const sample = new PositionSample();
  sample.addAll(positions, points.length);
  return chooseOrigin(sample.axes, centerBounds(positions, points.length), isWide);
}

const UTM = [500_000.25, 5_300_000.5, 700];
const at = (point: readonly number[], count: number) => Array.from({ length: count }, () => point);

/**
 * @fault Files: single failed or stray points lie far from the scene: at 0, at 1e7, on either side
 * @consequence all other splats keep their precision, because the origin is a median; a stray may be
 *   coarse
 */
describe('strays take no precision from the others', () => {
  const scene = sceneAt(UTM);
  test.each([
    { name: 'one at 0', strays: at([0, 0, 0], 1) },
    { name: 'ten at 1e7', strays: at([1e7, 1e7, 1e7], 10) },
    { name: 'ten beyond, by a fraction of the distance', strays: at([6e5, 6e6, 900], 10) },
    { name: 'on both sides', strays: [...at([-1e9, -1e9, -1e9], 12), ...at([1e9, 1e9, 1e9], 15)] },
    { name: 'at the end of the range of float32', strays: at([3e38, 0, 0], 1) },
    { name: 'that are no numbers', strays: at([Number.NaN, Number.NaN, 0], 200) },
    { name: 'a third, if positions are doubles', strays: at([0, 0, 0], 150) },
  ])('$name', ({ strays }) => {
    for (const points of [
      [...strays, ...scene],
      [...scene, ...strays],
    ]) {
      const origin = originOf(points);
      for (const [axis, value] of origin.entries()) expect(Math.abs(value - UTM[axis])).toBeLessThan(3);
      const errors = scene.map((point) =>
        Math.max(...point.map((value, k) => Math.abs(Math.fround(value - origin[k]) + origin[k] - value))),
      );
      expect(Math.max(...errors)).toBeLessThan(1e-6);
    }
  });

  test('nor does the larger of two scenes lose any to the other', () => {
    const [first, second] = [sceneAt(UTM, 300), sceneAt([-2e6, 40, 1e5], 200)];
    for (const points of [
      [...first, ...second],
      [...second, ...first],
    ])
      expect(originOf(points)[1]).toBeCloseTo(5_300_000, -1);
  });
});

test('scenes near 0 keep their coordinates, whatever lies around them', () => {
  for (const isWide of [true, false]) {
    for (const centre of [
      [0, 0, 0],
      [1, 2, -5],
      [5, -3, 4],
    ])
      for (const strays of [[], at([1e5, 0, 0], 5), at([-1e7, 1e7, 0], 10)])
        expect(originOf([...sceneAt(centre), ...strays], isWide)).toEqual([0, 0, 0]);
  }
});

describe('float32 coordinates', () => {
  const asFloat32 = (points: readonly (readonly number[])[]) => points.map((point) => point.map(Math.fround));
  const lossOf = (points: readonly (readonly number[])[]) => {
    const origin = originOf(points, false);
    return points.map((point) =>
      Math.max(...point.map((value, k) => Math.abs(Math.fround(value - origin[k]) + origin[k] - value))),
    );
  };

  test('are all exact without strays, and with strays all that are none', () => {
    const scene = asFloat32(sceneAt(UTM));
    expect(Math.max(...lossOf(scene))).toBe(0);
    const strays = asFloat32(at([0.1, 1e7 / 3, 7e8], 10));
    const losses = lossOf([...scene, ...strays]);
    expect(Math.max(...losses.slice(0, 300))).toBe(0);
    // Of the step that their neighbours have in the file.
    expect(Math.max(...losses)).toBeLessThanOrEqual(64);
    expect(originOf(scene, false)[1]).not.toBe(0);
    expect(originOf([...scene, ...strays], false)[1]).toBeCloseTo(5_300_000, -1);
  });

  test('are all exact where two scenes lie far apart: neither gains enough', () => {
    const both = asFloat32([...sceneAt(UTM, 300), ...sceneAt([0, 0, 0], 200)]);
    expect(Math.max(...lossOf(both))).toBe(0);
  });
});

test('the sample depends on the number of rows alone, and has all of few', () => {
  const points = sceneAt([0, 0, 0], 50_000);
  const positions = Float64Array.from(points.flat());
  const whole = new PositionSample();
  whole.addAll(positions, points.length);
  const parts = new PositionSample();
  const second = new PositionSample();
  for (let from = 0; from < points.length; from += 7_000) {
    const count = Math.min(7_000, points.length - from);
    const target = from < 28_000 ? parts : second;
    target.addAll(positions.subarray(3 * from), count, [0, 0, 0], from);
  }
  parts.addValues(second.valuesFrom(0));
  expect(parts.axes).toEqual(whole.axes);
  const rows = sampledRows(points.length);
  expect(Array.from(rows, (row) => points[row][1])).toEqual(Array.from(whole.axes[1]));
  expect(rows.length).toBeGreaterThan(2_000);
  expect(rows.length).toBeLessThan(4_200);
  expect(sampledRows(300)).toHaveLength(300);
});
