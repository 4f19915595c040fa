import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect, test } from 'vitest';
import { CutPlan, LEVEL_CONSTANTS, shiftedError } from '../../data/layout/level-structs.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { planCut as reference } from './cut.reference.ts';
import { planCut } from './cut.ts';

const { CUT_BINS, CUT_COPIES, ERROR_SHIFT, SHIFT_NONE, SHIFT_STEP } = LEVEL_CONSTANTS;
const gpu = testGpu();

/** Runs both steps with the counts of cut-count; returns the plan's shift. */
async function shiftFor(countAt: (shift: number) => number, leastShift: number, budget: number) {
  const plan = CutPlan.pack({ base: leastShift, step: SHIFT_STEP, shift: leastShift, budget });
  const cutPlan = gpu.storage(new Uint32Array(plan));
  for (let step = 0; step < 2; step++) {
    const [base, apart] = await gpu.read(cutPlan);
    const counts = Array.from({ length: CUT_BINS }, (_, bin) => countAt(base + apart * bin));
    const changes = counts.map((count, bin) => (count - (counts[bin - 1] ?? 0)) >>> 0);
    // Each copy has added an odd number besides, which the last one takes away.
    const copies = Array.from({ length: CUT_COPIES }, (_, copy) =>
      changes.map((change) => (copy < CUT_COPIES - 1 ? 7 : change - 7 * (CUT_COPIES - 1)) >>> 0),
    );
    const cutCounts = gpu.storage(copies.flat());
    await gpu.run(planCut, { cutPlan, cutCounts }, [1, 1, 1]);
    expect(await gpu.read(cutCounts)).toEqual(new Uint32Array(CUT_BINS * CUT_COPIES));
  }
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
  const falling = (shift: number) => Math.round(6e6 * 2 ** (-shift / 700));
  const rough = (shift: number) => falling(shift) + ((shift * 7919) % 1000);
  const cases: [name: string, countAt: (shift: number) => number, leastShift: number, budget: number][] = [
    ['a budget of a million', falling, 0, 1e6],
    ['a budget of a thousand', falling, 0, 1000],
    ['counts that do not only fall', rough, 0, 250_000],
    ['a budget beyond an error', falling, SHIFT_NONE, 50_000],
    ['a budget that the error keeps already', falling, SHIFT_NONE, 5e6],
    ['a budget that holds all', falling, 0, 6e6],
    ['a budget that nothing keeps', () => 100, 0, 10],
    ['a budget that only the first of 64 shifts misses', (shift) => (shift === 0 ? 11 : 10), 0, 10],
  ];
  for (const [name, countAt, leastShift, budget] of cases) {
    gpuTest(`finds the least shift for ${name}`, async () => {
      const shift = await shiftFor(countAt, leastShift, budget);
      expect(shift).toBe(reference(countAt, leastShift, budget));
    });
  }
});
