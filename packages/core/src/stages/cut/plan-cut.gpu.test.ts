import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect, test } from 'vitest';
import { CutPlan, LEVEL_CONSTANTS, shiftedError } from '../../data/layout/level-structs.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { planCut as reference } from './cut.reference.ts';
import { planCut } from './cut.ts';

const { COUNT_ANEW, COUNT_NOTHING, CUT_BINS, CUT_COPIES, ERROR_SHIFT, LEAST_SHIFT, SHIFT_NONE } =
  LEVEL_CONSTANTS;
const gpu = testGpu();

type CountAt = (shift: number) => number;

/** Plans frames one after the other with the counts that cut-count gives. */
class FramesPlanned {
  readonly #plan = gpu.storage([], CutPlan.bytes);
  /** Counts of the last frame that began at the least shift, or were left out. */
  wholeCounts = 0;

  /** @returns the shift of a frame. */
  async shiftFor(countAt: CountAt, leastShift: number, budget: number): Promise<number> {
    this.wholeCounts = 0;
    gpu.device.queue.writeBuffer(
      this.#plan,
      CutPlan.offsets.leastShift,
      new Uint32Array([leastShift, budget]),
    );
    for (let count = 0; count < 2; count++) await this.#count(countAt, leastShift);
    const [shift, next] = await this.#read('shift', 'next');
    expect(next).toBe(COUNT_ANEW);
    return shift;
  }

  async #count(countAt: CountAt, leastShift: number): Promise<void> {
    const [base, next] = await this.#read('base', 'next');
    const first = Math.max(base, leastShift);
    if (first === leastShift && next !== COUNT_NOTHING) this.wholeCounts++;
    const counts = Array.from({ length: CUT_BINS }, (_, bin) =>
      next === COUNT_NOTHING ? 0 : countAt(first + bin),
    );
    const changes = counts.map((each, bin) => (each - (counts[bin - 1] ?? 0)) >>> 0);
    // Each copy has added an odd number besides, which the last one takes away.
    const odd = next === COUNT_NOTHING ? 0 : 7;
    const copies = Array.from({ length: CUT_COPIES }, (_, copy) =>
      changes.map((change) => (copy < CUT_COPIES - 1 ? odd : change - odd * (CUT_COPIES - 1)) >>> 0),
    );
    const cutCounts = gpu.storage(copies.flat());
    await gpu.run(planCut, { cutPlan: this.#plan, cutCounts }, [1, 1, 1]);
    expect(await gpu.read(cutCounts)).toEqual(new Uint32Array(CUT_BINS * CUT_COPIES));
  }

  async #read(...fields: ('base' | 'shift' | 'next')[]): Promise<number[]> {
    const words = await gpu.read(this.#plan);
    return fields.map((field) => words[CutPlan.offsets[field] / 4]);
  }
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
  const falling = (shift: number) => Math.round(6e6 * 2 ** (-(shift - LEAST_SHIFT) / 70));
  const rough = (shift: number) => falling(shift) + ((shift * 7919) % 1000);
  const cases: [name: string, countAt: (shift: number) => number, leastShift: number, budget: number][] = [
    ['a budget of a million', falling, LEAST_SHIFT, 1e6],
    ['a budget of a thousand', falling, LEAST_SHIFT, 1000],
    ['counts that do not only fall', rough, LEAST_SHIFT, 25000],
    ['a budget beyond an error', falling, SHIFT_NONE, 5000],
    ['a budget that the error keeps already', falling, SHIFT_NONE, 5e5],
    ['a budget that holds all', falling, LEAST_SHIFT, 6e6],
    ['a budget that nothing keeps', () => 100, LEAST_SHIFT, 10],
    [
      'a budget that only the first shift misses',
      (shift) => (shift === LEAST_SHIFT ? 11 : 10),
      LEAST_SHIFT,
      10,
    ],
    [
      'a budget that only the last shift keeps',
      (shift) => (shift < LEAST_SHIFT + CUT_BINS - 1 ? 11 : 10),
      LEAST_SHIFT,
      10,
    ],
  ];
  for (const [name, countAt, leastShift, budget] of cases) {
    gpuTest(`finds the least shift for ${name}, whatever was drawn before`, async () => {
      const expected = reference(countAt, leastShift, budget);
      const fresh = new FramesPlanned();
      expect(await fresh.shiftFor(countAt, leastShift, budget)).toBe(expected);
      const others: [CountAt, number, number][] = [
        [falling, LEAST_SHIFT, 3e6],
        [falling, SHIFT_NONE, 100],
        [rough, LEAST_SHIFT, 20_000],
        [() => 0, LEAST_SHIFT, 1],
      ];
      for (const before of others) {
        const frames = new FramesPlanned();
        await frames.shiftFor(...before);
        expect(await frames.shiftFor(countAt, leastShift, budget)).toBe(expected);
        expect(await frames.shiftFor(countAt, leastShift, budget)).toBe(expected);
      }
    });
  }

  gpuTest('counts all shifts only where a budget has grown by much', async () => {
    const frames = new FramesPlanned();
    const wholeCountsFor = async (budget: number) => {
      await frames.shiftFor(falling, LEAST_SHIFT, budget);
      return frames.wholeCounts;
    };
    expect(await wholeCountsFor(10_000)).toBe(1);
    expect(await wholeCountsFor(10_000)).toBe(0);
    expect(await wholeCountsFor(100)).toBe(0);
    expect(await wholeCountsFor(130)).toBe(0);
    expect(await wholeCountsFor(10_000)).toBe(1);
  });
});
