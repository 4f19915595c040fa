import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { coefficientRows, packedRows } from '../../testing/coefficient-rows.ts';
import { uniform } from '../../testing/uniform.ts';
import { shRestBasis } from '../splats/spherical-harmonics.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../splats/splat-set.ts';
import { shBandReach } from './band-reach.ts';
import type { OwnShPrecision } from './precision.ts';
import { repackHarmonics } from './repack-harmonics.ts';

const PRECISIONS: readonly OwnShPrecision[] = ['f32', 'f16', 'u8'];

/** Unit vectors spread evenly over the sphere. */
const DIRECTIONS = Array.from({ length: 400 }, (_, i) => {
  const z = 1 - (2 * i + 1) / 400;
  const angle = i * Math.PI * (3 - Math.sqrt(5));
  const radius = Math.sqrt(1 - z * z);
  return [radius * Math.cos(angle), radius * Math.sin(angle), z] as const;
});

/** What `band` adds to a channel of a splat with these values, seen along `direction`. */
function bandChange(
  row: ArrayLike<number>,
  band: ShDegree,
  channel: number,
  direction: readonly [number, number, number],
): number {
  const from = SH_REST_COEFFICIENTS[(band - 1) as ShDegree];
  const basis = shRestBasis(band, ...direction);
  let sum = 0;
  for (let k = from; k < basis.length; k++) sum += basis[k] * row[3 * k + channel];
  return sum;
}

describe('how far a band reaches', () => {
  const BANDS: readonly ShDegree[] = [1, 2, 3];
  const CHANNELS = [0, 1, 2];

  test('is never exceeded, nor missed by more than the root of its number of coefficients', () => {
    fc.assert(
      fc.property(coefficientRows(3), (rows) => {
        const reach = shBandReach(packedRows(3, 'f32', rows), rows.length);
        expect(reach).toHaveLength(3);
        for (const band of BANDS) {
          const changes = rows.flatMap((row) =>
            CHANNELS.flatMap((channel) => DIRECTIONS.map((d) => Math.abs(bandChange(row, band, channel, d)))),
          );
          const most = Math.max(...changes);
          expect(most).toBeLessThanOrEqual(reach[band - 1] * (1 + 1e-9));
          // The rest is for the directions in between.
          expect(most).toBeGreaterThanOrEqual((0.99 * reach[band - 1]) / Math.sqrt(2 * band + 1));
        }
      }),
      { numRuns: 30 },
    );
  });

  test('is attained by the splat that is made for a direction', () => {
    fc.assert(
      fc.property(
        fc.constantFrom(...BANDS),
        fc.constantFrom(...CHANNELS),
        fc.constantFrom(...DIRECTIONS),
        uniform(-10, 10),
        (band, channel, direction, size) => {
          const row = new Array<number>(45).fill(0);
          const basis = shRestBasis(band, ...direction);
          for (let k = SH_REST_COEFFICIENTS[(band - 1) as ShDegree]; k < basis.length; k++)
            row[3 * k + channel] = Math.fround(size * basis[k]);
          const reach = shBandReach(packedRows(3, 'f32', [new Array<number>(45).fill(0), row]), 2);
          const change = Math.abs(bandChange(row, band, channel, direction));
          // The steps of float32 end somewhere.
          expect(Math.abs(reach[band - 1] - change)).toBeLessThanOrEqual(1e-6 * change + 2 ** -145);
          expect(reach.filter((each) => each !== 0).length).toBeLessThanOrEqual(1);
        },
      ),
    );
  });

  test('is that of the coefficients before they were rounded, whatever they are repacked to', () => {
    // A value that a byte next to the 1 cannot hold.
    const row = [1, ...new Array<number>(43).fill(0), 0.002];
    const exact = packedRows(3, 'f32', [row.map(Math.fround)]);
    const reach = shBandReach(exact, 1);
    expect(reach[2]).toBeCloseTo(Math.sqrt(7 / (4 * Math.PI)) * 0.002, 9);
    for (const precision of PRECISIONS)
      expect(shBandReach(repackHarmonics(exact, 1, precision), 1)).toEqual(reach);
    expect(shBandReach(packedRows(3, 'u8', [row]), 1)[2]).toBe(0);
    expect(shBandReach(packedRows(0, 'u8', [[]]), 1)).toEqual([]);
  });
});
