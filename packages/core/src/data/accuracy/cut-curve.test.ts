import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { type CutPoint, predictPsnrDb, predictShare } from './cut-curve.ts';

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

  test('are typical where nothing was measured', () => {
    expect(predictPsnrDb([], 0.25)).toBe(32);
    expect(predictShare([], 38)).toBe(0.5);
  });

  test('are numbers, whatever was measured', () => {
    fc.assert(
      fc.property(points, fc.double({ min: 20, max: 80, noNaN: true }), (measured, psnrDb) => {
        const share = predictShare(measured, psnrDb);
        expect(share).toBeGreaterThan(0);
        expect(Number.isFinite(predictPsnrDb(measured, share))).toBe(true);
      }),
    );
  });
});
