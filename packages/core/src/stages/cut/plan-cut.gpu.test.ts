import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect, test } from 'vitest';
import { CutPlan, LEVEL_CONSTANTS, shiftedError } from '../../data/layout/level-structs.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { planCut as reference } from './cut.reference.ts';
import { planCut } from './cut.ts';

const { CUT_BINS, CUT_COPIES, ERROR_SHIFT, SHIFT_NONE } = LEVEL_CONSTANTS;
/** The first shift without a least error. */
const FIRST = SHIFT_NONE - CUT_BINS / 2;
const gpu = testGpu();

/** Runs the stage with the counts of cut-count; returns the plan's shift. */
async function shiftFor(countAt: (shift: number) => number, base: number, budget: number) {
  const cutPlan = gpu.storage(new Uint32Array(CutPlan.pack({ base, shift: 0, budget })));
  const counts = Array.from({ length: CUT_BINS }, (_, bin) => countAt(base + bin));
  const changes = counts.map((count, bin) => (count - (counts[bin - 1] ?? 0)) >>> 0);
  // Each copy has added an odd number besides, which the last one takes away.
  const copies = Array.from({ length: CUT_COPIES }, (_, copy) =>
    changes.map((change) => (copy < CUT_COPIES - 1 ? 7 : change - 7 * (CUT_COPIES - 1)) >>> 0),
  );
  const cutCounts = gpu.storage(copies.flat());
  await gpu.run(planCut, { cutPlan, cutCounts }, [1, 1, 1]);
  expect(await gpu.read(cutCounts)).toEqual(new Uint32Array(CUT_BINS * CUT_COPIES));
  return (await gpu.read(cutPlan))[CutPlan.offsets.shift / 4];
}

test.each([-700, -33, -1, 0, 1, 15, 900])('an error is shifted by %i codes as thresholds are', (codes) => {
  for (const error of [1, 1.1, 1.4]) {
    const bits = new DataView(new ArrayBuffer(4));
    bits.setFloat32(0, error ** 2);
    bits.setUint32(0, bits.getUint32(0) + (codes << ERROR_SHIFT));
    expect(shiftedError(error, SHIFT_NONE + codes) / Math.sqrt(bits.getFloat32(0))).toBeCloseTo(1, 1);
  }
});

describe('plan-cut', () => {
  const falling = (shift: number) => Math.round(6e6 * 2 ** (-(shift - FIRST) / 70));
  const rough = (shift: number) => falling(shift) + ((shift * 7919) % 1000);
  const cases: [name: string, countAt: (shift: number) => number, leastShift: number, budget: number][] = [
    ['a budget of a million', falling, FIRST, 1e6],
    ['a budget of a thousand', falling, FIRST, 1000],
    ['counts that do not only fall', rough, FIRST, 25000],
    ['a budget beyond an error', falling, SHIFT_NONE, 5000],
    ['a budget that the error keeps already', falling, SHIFT_NONE, 5e5],
    ['a budget that holds all', falling, FIRST, 6e6],
    ['a budget that nothing keeps', () => 100, FIRST, 10],
    ['a budget that only the first shift misses', (shift) => (shift === FIRST ? 11 : 10), FIRST, 10],
    [
      'a budget that only the last shift keeps',
      (shift) => (shift < FIRST + CUT_BINS - 1 ? 11 : 10),
      FIRST,
      10,
    ],
  ];
  for (const [name, countAt, leastShift, budget] of cases) {
    gpuTest(`finds the least shift for ${name}`, async () => {
      const shift = await shiftFor(countAt, leastShift, budget);
      expect(shift).toBe(reference(countAt, leastShift, budget));
    });
  }
});
