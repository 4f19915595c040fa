import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../data/errors.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { logScalesOf } from '../../data/packing/chunks.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { SplatMorph } from './splat-morph.data.ts';

const PRECISION = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;
const COUNT = 600;
const FROM = randomSplats({ count: COUNT, shDegree: 1, seed: 1 });
const TO = randomSplats({ count: COUNT, shDegree: 1, seed: 2, halfExtent: 3, logScales: [-8, 0] });

describe('a morph', () => {
  test('stores row i of both sets in one place, about one origin', () => {
    const far = { ...TO, origin: [100, 0, 0] as const };
    const { packed, second } = new SplatMorph(FROM, far, PRECISION);
    const [a, b] = [packed, second].map(({ geometry }) => new Float32Array(geometry.words.buffer));
    for (const [i, row] of packed.fileIndices.entries()) {
      expect(a[16 * i] + packed.origin[0]).toBeCloseTo(FROM.positions[3 * row], 4);
      expect(b[16 * i] + packed.origin[0]).toBeCloseTo(TO.positions[3 * row] + 100, 4);
    }
    expect(packed.bounds.max[0]).toBeGreaterThan(102);
  });

  test('bounds centres and sizes of both sets, chunk by chunk', () => {
    const { packed, second } = new SplatMorph(FROM, TO, PRECISION);
    const chunks = new Float32Array(packed.chunks);
    for (const { geometry } of [packed, second]) {
      const values = new Float32Array(geometry.words.buffer);
      for (let i = 0; i < COUNT; i++) {
        const chunk = Math.floor(i / CHUNK_SPLATS);
        const { min, step } = logScalesOf(chunks, chunk);
        for (let axis = 0; axis < 3; axis++) {
          const position = values[16 * i + axis];
          expect(position).toBeGreaterThanOrEqual(chunks[8 * chunk + axis]);
          expect(position).toBeLessThanOrEqual(chunks[8 * chunk + 4 + axis]);
          const logScale = Math.log(values[16 * i + 8 + axis]);
          expect(logScale).toBeGreaterThan(min - 1e-5);
          expect(logScale).toBeLessThan(min + 65535 * step + 1e-5);
        }
      }
    }
  });

  test('keeps its amount between 0 and 1, and refuses what is no number', () => {
    const morph = new SplatMorph(FROM, TO, PRECISION);
    expect(morph.amount).toBe(0);
    for (const [amount, kept] of [
      [0.3, 0.3],
      [-1, 0],
      [Number.POSITIVE_INFINITY, 1],
    ]) {
      morph.amount = amount;
      expect(morph.amount).toBe(kept);
    }
    for (const amount of [Number.NaN, '0.5' as unknown as number])
      expect(() => {
        morph.amount = amount;
      }).toThrow(InvalidArgumentError);
    expect(morph.amount).toBe(1);
  });

  test('of no splats has none', () => {
    const none = randomSplats({ count: 0 });
    expect(new SplatMorph(none, none, PRECISION).packed.count).toBe(0);
  });

  test('refuses sets of different sizes, with both, and what is no set', () => {
    const fewer = randomSplats({ count: COUNT - 1, shDegree: 1 });
    expect(() => new SplatMorph(FROM, fewer, PRECISION)).toThrow(/600 splats and to has 599/);
    expect(() => new SplatMorph(FROM, {} as typeof TO, PRECISION)).toThrow(InvalidArgumentError);
    const precision = { ...PRECISION, geometryPrecision: 'f8' } as unknown as typeof PRECISION;
    expect(() => new SplatMorph(FROM, TO, precision)).toThrow(InvalidArgumentError);
  });

  test('refuses splats that are not finite, instead of parting rows', () => {
    const broken = { ...TO, positions: TO.positions.slice() };
    broken.positions[4] = Number.NaN;
    expect(() => new SplatMorph(FROM, broken, PRECISION)).toThrow(/^to has 1 splats/);
  });
});
