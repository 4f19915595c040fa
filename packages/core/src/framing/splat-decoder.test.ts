import { describe, expect, test } from 'vitest';
import { multiply4 } from '../data/math/mat4.ts';
import { chunksOf, logScalesOf } from '../data/packing/chunks.ts';
import { packGeometry } from '../data/packing/geometry.ts';
import type { GeometryPrecision } from '../data/packing/precision.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { type SplatValues, splatsOf } from '../testing/random-splats.ts';
import { decodeSamples } from './splat-decoder.ts';

const MOVED = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1];
/** x to y, y to z, z to x, and twice as large. */
const TURNED = [0, 2, 0, 0, 0, 0, 2, 0, 2, 0, 0, 0, 0, 0, 0, 1];
const SQUASHED = [1, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

function decoded(set: SplatSet, matrix: readonly number[], precision: GeometryPrecision = 'f32') {
  const { words } = packGeometry(set, precision);
  const { min, step } = logScalesOf(chunksOf(set), 0);
  const part = {
    precision,
    words: new Uint32Array(words),
    logScales: Float32Array.from({ length: 2 * set.count }, (_, i) => (i % 2 === 0 ? min : step)),
    instances: new Uint32Array(set.count),
    origin: set.origin,
    matrices: Float64Array.from(matrix),
    opacities: Float64Array.of(0.5),
  };
  return decodeSamples([part], 1);
}

/** Turned about x by an angle, in degrees. */
function turnedAboutX(degrees: number): SplatValues['rotation'] {
  const half = (degrees * Math.PI) / 360;
  return [Math.cos(half), Math.sin(half), 0, 0];
}

const values = (list: ArrayLike<number>) => Array.from(list, (value) => Math.round(value * 1e4) / 1e4 + 0);

describe('sampled splats in the world', () => {
  test('are those that can be seen', () => {
    const hidden = { opacityLogit: Number.NEGATIVE_INFINITY };
    const { count, positions, opacities, sigmas, normals } = decoded(
      splatsOf([hidden, { position: [1, 2, 3] }, hidden]),
      MOVED,
    );
    expect(count).toBe(1);
    expect([...positions, ...opacities]).toEqual([11, 22, 33, 0.5]);
    expect([sigmas.length, normals.length]).toEqual([3, 3]);
  });

  for (const precision of ['f32', 'packed'] as const)
    test(`have their places, sizes and normals, ${precision}`, () => {
      const set = splatsOf([
        { position: [1, 2, 3], logScales: [-1, -3, -2], opacityLogit: 0 },
        { logScales: [-1, -2, -3], rotation: turnedAboutX(90) },
      ]);
      const { count, positions, sigmas, normals, opacities } = decoded(set, TURNED, precision);
      expect(count).toBe(2);
      expect([...positions]).toEqual([6, 2, 4, 0, 0, 0]);
      for (let i = 0; i < 2; i++)
        for (let k = 0; k < 3; k++) expect(sigmas[3 * i + k]).toBeCloseTo(2 * Math.exp(k - 3), 4);
      // y of the splat, which is z of the world; and z, turned to −y, which is −z.
      expect(values(normals).map(Math.abs)).toEqual([0, 0, 1, 0, 0, 1]);
      expect(opacities[0]).toBeCloseTo(0.25, 4);
      expect(opacities[1]).toBe(0.5);
    });

  test('keep millimetres a thousand kilometres from the origin', () => {
    const origin = [1e7, -2e7, 3e6] as const;
    const set = { ...splatsOf([{ position: [0.001, 0.25, -0.5] }]), origin };
    const { positions } = decoded(set, MOVED);
    expect(positions[0]).toBeCloseTo(1e7 + 10.001, 6);
    expect([...positions.subarray(1)]).toEqual([-2e7 + 20.25, 3e6 + 29.5]);
  });

  test('keep normals across their plane where scales are uneven', () => {
    // A thin plane at 45°; y four times as long makes it steeper: its normal leans to z.
    const set = splatsOf([{ logScales: [0, 0, -9], rotation: turnedAboutX(45) }]);
    const { normals, sigmas } = decoded(set, SQUASHED);
    const [x, y, z] = normals;
    expect(x).toBeCloseTo(0, 6);
    expect(Math.abs(y / z)).toBeCloseTo(0.25, 5);
    // Its own axis y is turned to (0, 1, 1)/√2, and made √(17/2) as long.
    expect(sigmas[2]).toBeCloseTo(Math.sqrt(8.5), 5);
  });

  test('have unit normals and ascending sizes under any matrix', () => {
    const mirrored = [-1, 0, 0, 0, 0, 3, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1];
    const line = [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1];
    const set = splatsOf([{ logScales: [-1, -2, -5], rotation: [0.5, -0.5, 0.5, 0.5] }, {}]);
    for (const matrix of [mirrored, line, multiply4(TURNED, mirrored), new Array(16).fill(0)]) {
      const { normals, sigmas } = decoded(set, Array.from(matrix));
      for (let i = 0; i < 2; i++) {
        expect(Math.hypot(...normals.subarray(3 * i, 3 * i + 3))).toBeCloseTo(1, 6);
        const own = sigmas.subarray(3 * i, 3 * i + 3);
        expect(own).toEqual(own.toSorted());
      }
    }
  });
});
