import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { encodePly } from '../../io/formats/ply/write-ply.ts';
import { loadSplats } from '../../io/loading/load-splats.ts';
import { readSplats } from '../../io/loading/read-splats.ts';
import { renderReference } from '../../reference/render.ts';
import { shColor } from '../../stages/project/project.reference.ts';
import { ownHarmonics } from '../../testing/own-harmonics.ts';
import { randomSplats, splatsOf } from '../../testing/random-splats.ts';
import { splatsOfDegree } from '../../testing/splats-of-degree.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import {
  coefficientsPerSplat,
  SH_REST_COEFFICIENTS,
  type ShDegree,
  type SplatSet,
} from '../splats/splat-set.ts';
import { cloudFacts, UNSEEN_CHANGE } from './cloud-facts.ts';
import { readCoefficients } from './harmonics.ts';
import { packSet } from './pack-set.ts';
import { packCloud } from './packed-cloud.ts';
import type { ShPrecision } from './precision.ts';
import { packHarmonics, repackHarmonics } from './repack-harmonics.ts';

const PRECISIONS: readonly ShPrecision[] = ['f32', 'f16', 'u8'];
const DEGREES: readonly ShDegree[] = [0, 1, 2, 3];

/** Random splats of degree 3, each band multiplied by its factor. */
function splatsWithBands(factors: readonly [number, number, number], count = 40): SplatSet {
  const set = randomSplats({ count });
  const values = set.harmonics.coefficients;
  for (let i = 0; i < values.length; i++) {
    const coefficient = Math.floor((i % 45) / 3);
    const band = DEGREES.findIndex((degree) => coefficient < SH_REST_COEFFICIENTS[degree]);
    values[i] *= factors[band - 1];
  }
  return set;
}

describe('bands that cannot be seen', () => {
  const factor = fc.oneof(
    fc.constant(0),
    fc.integer({ min: -60, max: 0 }).map((tenths) => 10 ** (tenths / 10)),
  );

  test('change no colour by more than the threshold, and no more of them could be left out', () => {
    fc.assert(
      fc.property(
        fc.tuple(factor, factor, factor),
        fc.infiniteStream(fc.double({ min: -1, max: 1, noNaN: true })),
        (factors, stream) => {
          const set = splatsWithBands(factors);
          const { trueShDegree, shBandReach } = cloudFacts(set);
          const rest = new Float64Array(coefficientsPerSplat(3));
          for (let i = 0; i < set.count; i++) {
            readCoefficients(set.harmonics, i, rest);
            const dc = set.colorDc.subarray(3 * i, 3 * i + 3);
            const direction = unit([0, 1, 2].map(() => stream.next().value as number));
            const whole = shColor(3, dc, rest, direction);
            for (const [channel, value] of shColor(trueShDegree, dc, rest, direction).entries())
              expect(Math.abs(value - whole[channel])).toBeLessThan(UNSEEN_CHANGE);
          }
          const unseen = shBandReach.slice(trueShDegree).reduce((sum, reach) => sum + reach, 0);
          expect(unseen).toBeLessThan(UNSEEN_CHANGE);
          if (trueShDegree > 0)
            expect(unseen + shBandReach[trueShDegree - 1]).toBeGreaterThanOrEqual(UNSEEN_CHANGE);
        },
      ),
    );
  });

  test('change no pixel by more than that', () => {
    const set = splatsWithBands([1, 3e-4, 1e-4], 300);
    const { trueShDegree } = cloudFacts(set);
    expect(trueShDegree).toBe(1);
    const imageOf = (each: SplatSet) =>
      renderReference({
        clouds: [{ set: each }],
        camera: testCameras(1).perspective,
        widthPx: 32,
        heightPx: 32,
      }).data;
    const whole = imageOf(set);
    const changes = imageOf(splatsOfDegree(set, trueShDegree)).map((value, i) => Math.abs(value - whole[i]));
    const most = changes.reduce((largest, change) => Math.max(largest, change), 0);
    expect(most).toBeLessThan(UNSEEN_CHANGE);
    expect(most).toBeGreaterThan(UNSEEN_CHANGE / 100);
  });

  for (const degree of DEGREES) {
    test(`a file of zeros above degree ${degree} is packed as one of that degree, whichever way it comes`, async () => {
      const factors = [1, 2, 3].map((band) => (band <= degree ? 1 : 0)) as [number, number, number];
      const set = splatsWithBands(factors);
      const file = new Blob([encodePly(set)]);
      const lower = splatsOfDegree(set, degree);
      const lowerFile = new Blob([encodePly(lower)]);
      for (const geometryPrecision of ['f32', 'packed'] as const) {
        for (const shPrecision of PRECISIONS) {
          const precision = { geometryPrecision, shPrecision };
          const expected = packSet(lower, precision);
          expect(expected.harmonics).toMatchObject({ degree, precision: shPrecision });
          const read = await readSplats(file, { shPrecision });
          for (const packed of [
            await loadSplats(file, precision),
            packSet(set, precision),
            packCloud(set, precision),
            packCloud(read, { geometryPrecision }),
          ]) {
            // Only what was read of a file says what that was.
            const { fileFacts } = packed.facts;
            const facts = { ...expected.facts, declaredShDegree: 3, fileFacts };
            expect(packed.facts).toEqual({
              ...facts,
              shBandReach: [...facts.shBandReach, 0, 0, 0].slice(0, 3),
            });
            expect({ ...packed, facts: expected.facts, harmonics: null }).toEqual({
              ...expected,
              harmonics: null,
            });
            expect(packed.harmonics).toEqual(expected.harmonics);
          }
          const { facts, ...loaded } = await loadSplats(lowerFile, precision);
          expect({ ...loaded, facts: { ...facts, fileFacts: null } }).toEqual(expected);
        }
      }
    });
  }

  test('are the same for any precision, even one too coarse for the band that decides', async () => {
    const set = splatsWithBands([1, 0, 0.01]);
    const values = set.harmonics.coefficients;
    // Next to this a byte rounds all of band 3 away.
    for (let i = 0; i < set.count; i++) values[45 * i] = 2;
    const file = new Blob([encodePly(set)]);
    const { shBandReach } = cloudFacts(set);
    for (const shPrecision of PRECISIONS) {
      const precision = { geometryPrecision: 'packed', shPrecision } as const;
      const coarse = { ...set, harmonics: repackHarmonics(packHarmonics(set.harmonics), set.count, 'u8') };
      for (const packed of [
        await loadSplats(file, precision),
        packSet(set, precision),
        packSet(coarse, precision),
        packCloud(await readSplats(file), precision),
      ]) {
        expect(packed.facts).toMatchObject({ declaredShDegree: 3, trueShDegree: 3, shBandReach });
        expect(packed.harmonics).toMatchObject({ degree: 3, precision: shPrecision });
      }
    }
    // Who has bytes alone knows no better.
    const { bandReach, ...bytes } = repackHarmonics(packHarmonics(set.harmonics), set.count, 'u8');
    expect(cloudFacts({ ...set, harmonics: bytes }).trueShDegree).toBe(1);
  });

  test('stay in the splats that were packed', () => {
    const set = splatsWithBands([0, 0, 0]);
    const coefficients = set.harmonics.coefficients.slice();
    const { harmonics } = packSet(set, { geometryPrecision: 'packed', shPrecision: 'f32' });
    expect(ownHarmonics(harmonics).words).toHaveLength(0);
    expect(set.harmonics).toMatchObject({ degree: 3, coefficients });
  });
});

function unit([x, y, z]: number[]): [number, number, number] {
  const length = Math.hypot(x, y, z);
  return length > 0 ? [x / length, y / length, z / length] : [0, 0, 1];
}

test('splats are round where the three scales of each are the same', () => {
  const round = (logScale: number) => ({ logScales: [logScale, logScale, logScale] });
  expect(cloudFacts(splatsOf([round(-3), round(-1), round(0)])).isIsotropic).toBe(true);
  for (const axis of [0, 1, 2]) {
    const logScales = [-2, -2, -2];
    logScales[axis] = -2 + 2 ** -22;
    expect(cloudFacts(splatsOf([round(-3), { logScales }])).isIsotropic).toBe(false);
  }
});

test('the antialiasing that a format states arrives, even where splats are left out', () => {
  const set = randomSplats({ count: 5 });
  const precision = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
  expect(packSet(set, precision).facts.isAntialiased).toBeNull();
  set.positions[3] = Number.NaN;
  for (const isAntialiased of [true, false]) {
    const packed = packSet({ ...set, isAntialiased }, precision);
    expect(packed.count).toBe(4);
    expect(packed.facts.isAntialiased).toBe(isAntialiased);
  }
});

test('splats that are left out decide nothing', () => {
  const set = splatsWithBands([0, 0, 0], 3);
  set.harmonics.coefficients[50] = 1;
  set.positions[4] = Number.POSITIVE_INFINITY;
  const { facts } = packSet(set, { geometryPrecision: 'packed', shPrecision: 'u8' });
  expect(facts).toMatchObject({ trueShDegree: 0, shBandReach: [0, 0, 0] });
});

test('no splats call for nothing', () => {
  expect(cloudFacts(randomSplats({ count: 0 }))).toEqual({
    declaredShDegree: 3,
    trueShDegree: 0,
    shBandReach: [0, 0, 0],
    paletteEntries: null,
    isIsotropic: true,
    isAntialiased: null,
    fileFacts: null,
  });
});
