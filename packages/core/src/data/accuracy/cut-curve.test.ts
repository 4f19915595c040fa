import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { type CutPoint, predictCertainShare, predictPsnrDb, predictShare } from './cut-curve.ts';

const points = fc.array(
  fc.record({
    share: fc.double({ min: 1e-3, max: 1, noNaN: true }),
    psnrDb: fc.oneof(fc.double({ min: 10, max: 90, noNaN: true }), fc.constant(Number.POSITIVE_INFINITY)),
  }),
  { maxLength: 3 },
);

describe('predictions of cuts', () => {
  test('are what was measured, where it was', () => {
    const measured: CutPoint[] = [
      { share: 0.5, psnrDb: 44 },
      { share: 0.25, psnrDb: 40 },
    ];
    for (const { share, psnrDb } of measured) {
      expect(predictPsnrDb(measured, share)).toBe(psnrDb);
      expect(predictShare(measured, psnrDb)).toBe(share);
    }
    expect(predictPsnrDb(measured, 0.125)).toBeCloseTo(36, 10);
    expect(predictShare(measured, 36)).toBeCloseTo(0.125, 10);
  });

  test('begin somewhere where nothing is known', () => {
    const equal = [{ share: 0.5, psnrDb: Number.POSITIVE_INFINITY }];
    for (const known of [[], equal]) {
      expect(predictPsnrDb(known, 0.25)).toBeNull();
      expect(predictShare(known, 38)).toBe(1 / 8);
    }
  });

  test('fall by four decibels with half of the splats where one cut is known', () => {
    const known = [{ share: 0.25, psnrDb: 40 }];
    expect(predictPsnrDb(known, 0.125)).toBe(36);
    expect(predictShare(known, 44)).toBe(0.5);
  });

  test('lie between known cuts where they can', () => {
    const known = [
      { share: 1 / 8, psnrDb: 24 },
      { share: 1 / 32, psnrDb: 18 },
      { share: 1 / 2, psnrDb: 72 },
    ];
    expect(predictShare(known, 48)).toBeCloseTo(1 / 4, 10);
    expect(predictCertainShare(known, 48)).toBe(predictShare(known, 48));
    expect(predictShare(known, 15)).toBeLessThan(1 / 32);
    expect(predictCertainShare(known, 15)).toBe(1 / 32);
    expect(predictPsnrDb(known, 1 / 4)).toBeCloseTo(48, 10);
    expect(predictPsnrDb(known, 1 / 16)).toBeCloseTo(21, 10);
  });

  test('count equal pictures as better than any', () => {
    const known = [
      { share: 1 / 8, psnrDb: 24 },
      { share: 1 / 2, psnrDb: Number.POSITIVE_INFINITY },
    ];
    const share = predictShare(known, 40);
    expect(share).toBeGreaterThan(1 / 8);
    expect(share).toBeLessThan(1 / 4);
  });

  test('are numbers, whatever was measured', () => {
    fc.assert(
      fc.property(points, fc.double({ min: 20, max: 80, noNaN: true }), (measured, psnrDb) => {
        const share = predictShare(measured, psnrDb);
        expect(share).toBeGreaterThan(0);
        const isKnown = measured.some((cut) => Number.isFinite(cut.psnrDb));
        expect(Number.isFinite(predictPsnrDb(measured, share))).toBe(isKnown);
      }),
    );
  });
});
