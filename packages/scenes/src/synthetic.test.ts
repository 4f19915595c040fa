import { readCoefficients, readSplats, type ShDegree } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { SYNTHETIC_MAX_SPLATS, SYNTHETIC_MIN_SPLATS, type SyntheticOptions, syntheticPly } from './index.ts';

/** More than one piece, the last of them not full. */
const SPLATS = 20_000;

async function bytesOf(options: SyntheticOptions): Promise<Buffer> {
  return Buffer.from(await new Response(syntheticPly(options)).arrayBuffer());
}

describe('syntheticPly', () => {
  it.each([0, 1, 2, 3] satisfies ShDegree[])('is a PLY of as many splats, of degree %i', async (shDegree) => {
    const set = await readSplats(syntheticPly({ splats: SPLATS, shDegree }), { shPrecision: 'f32' });
    expect([set.count, set.harmonics.degree, set.dropped]).toEqual([SPLATS, shDegree, {}]);
  });

  it('has the same bytes for the same seed, and others for another', async () => {
    const options = { splats: SYNTHETIC_MIN_SPLATS, shDegree: 1, seed: 4 } as const;
    const bytes = await bytesOf(options);
    expect(bytes.equals(await bytesOf(options))).toBe(true);
    const others = await bytesOf({ ...options, seed: 5 });
    expect(others.length).toBe(bytes.length);
    expect(bytes.equals(others)).toBe(false);
  });

  it('makes flat splats of every opacity, nearer than the dome, that cover no more area the more there are', async () => {
    const areas: number[] = [];
    for (const splats of [SYNTHETIC_MIN_SPLATS, 4 * SYNTHETIC_MIN_SPLATS]) {
      const { positions, logScales, opacityLogits, count } = await readSplats(
        syntheticPly({ splats, shDegree: 0 }),
      );
      let area = 0;
      for (let i = 0; i < count; i++) {
        expect(Math.hypot(...positions.subarray(3 * i, 3 * i + 3))).toBeLessThan(81);
        area += Math.exp(logScales[3 * i] + logScales[3 * i + 1]);
      }
      areas.push(area);
      const opaque = opacityLogits.filter((logit) => logit > 1).length / count;
      expect(opaque).toBeGreaterThan(0.45);
      expect(opaque).toBeLessThan(0.75);
      const flat = Array.from({ length: count }, (_, i) => logScales[3 * i + 2] < logScales[3 * i]);
      expect(flat.filter(Boolean).length / count).toBeGreaterThan(0.9);
    }
    expect(Math.abs(areas[1] / areas[0] - 1)).toBeLessThan(0.15);
  });

  it('has harmonics that fade from band to band', async () => {
    const { harmonics, count } = await readSplats(syntheticPly({ splats: SYNTHETIC_MIN_SPLATS }), {
      shPrecision: 'f32',
    });
    const values = new Float64Array(45);
    const energies = [0, 0, 0];
    for (let i = 0; i < count; i++) {
      readCoefficients(harmonics, i, values);
      for (const [at, value] of values.entries()) energies[at < 9 ? 0 : at < 24 ? 1 : 2] += value * value;
    }
    const deviations = energies.map((energy, band) => Math.sqrt(energy / (count * [9, 15, 21][band])));
    for (const [band, expected] of [0.14, 0.07, 0.035].entries())
      expect(deviations[band] / (expected * Math.hypot(1, 0.3))).toBeCloseTo(1, 1);
  });

  it('makes nothing before it is asked, and stops when it is cancelled', async () => {
    const reader = syntheticPly({ splats: SYNTHETIC_MAX_SPLATS }).getReader();
    const header = new TextDecoder().decode((await reader.read()).value);
    expect(header).toContain(`element vertex ${SYNTHETIC_MAX_SPLATS}\n`);
    await reader.cancel();
    expect(await reader.read()).toEqual({ done: true, value: undefined });
  });

  it.each([SYNTHETIC_MIN_SPLATS - 1, SYNTHETIC_MAX_SPLATS + 1, 12_345.5, Number.NaN])(
    'refuses %d splats',
    (splats) => expect(() => syntheticPly({ splats })).toThrow(RangeError),
  );
});
