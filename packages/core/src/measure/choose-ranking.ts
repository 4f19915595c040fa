import { type BallotDevice, hasNarrowSubgroups } from '../gpu/device.ts';
import { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { RadixSort, radixSortStages } from '../stages/radix-sort.ts';
import { pairSortShapeFor, type SortShape, sortShapeFor } from '../stages/sort-shape.ts';
import { timeSpread } from './time-spread.ts';

/** Random keys of 32 bits to sort: enough to fill the device, few enough for a fraction of a frame. */
const KEYS = 1 << 18;
/** Sorts that are timed together: browsers round times to 0.1 ms. */
const SORTS = 8;
/** Turns of both. */
const TURNS = 5;
/** Ballots must take less than this part of the time that masks take. */
const WORTH_IT = 0.97;

/**
 * Returns whether sorts are faster on this device by ballots than by masks, and right. If so, it has compiled all sorts of frames
 * for that. Takes some milliseconds of the GPU, and memory of 8 MB, which it frees.
 *
 * @param availableBytes most that it may take.
 * @throws GpuLimitError.
 */
export async function isFasterByBallots(
  device: GPUDevice,
  pipelines: Pipelines,
  ballots: BallotDevice,
  availableBytes = Number.POSITIVE_INFINITY,
): Promise<boolean> {
  const shapesOf = (by: BallotDevice | null) => {
    const traits = [device.limits.maxComputeWorkgroupStorageSize, hasNarrowSubgroups(device), by] as const;
    // One for each length of digits; the number of passes makes no difference to the shaders.
    return [sortShapeFor(32, ...traits), pairSortShapeFor(9, ...traits)];
  };
  const [[byMasks], [byBallots]] = [shapesOf(null), shapesOf(ballots)];
  if (!byBallots.subgroups) return false;
  const { isSameOrder, medianMs } = await compareSorts(device, pipelines, [byMasks, byBallots], {
    availableBytes,
  });
  if (!isSameOrder || medianMs[1] >= WORTH_IT * medianMs[0]) return false;
  await pipelines.prepare(shapesOf(ballots).flatMap((shape) => radixSortStages(shape)));
  return true;
}

export interface CompareSortsOptions {
  /** Random keys of 32 bits. */
  readonly keyCount?: number;
  /** Sorts that are timed together. */
  readonly sortsPerTurn?: number;
  readonly turns?: number;
  /** Most memory that it may take; default no limit. */
  readonly availableBytes?: number;
}

/**
 * Sorts the same keys in two ways: whether both give the same order, and the GPU's time for some sorts, ms.
 *
 * @throws GpuLimitError.
 */
export async function compareSorts(
  device: GPUDevice,
  pipelines: Pipelines,
  shapes: readonly [SortShape, SortShape],
  { keyCount: count = KEYS, sortsPerTurn = SORTS, turns = TURNS, availableBytes }: CompareSortsOptions = {},
): Promise<{ readonly isSameOrder: boolean; readonly medianMs: readonly number[] }> {
  await pipelines.prepare(shapes.flatMap((shape) => radixSortStages(shape)));
  // Not the engine's memory, whose peak would count these, and which may end meanwhile.
  const memory = new GpuMemory(device, availableBytes);
  const make = () => {
    const keys = randomKeys(memory, count);
    const keyCount = memory.createFilledBuffer('ranking key count', Uint32Array.of(count));
    const dispatchRow = device.limits.maxComputeWorkgroupsPerDimension;
    const sorts = shapes.map(
      (shape) => new RadixSort(device, pipelines, memory, { shape, capacity: count, keyCount, dispatchRow }),
    );
    const { QUERY_RESOLVE, COPY_SRC } = GPUBufferUsage;
    const stampBytes = 8 * stampsOf(turns, sorts.length);
    const resolved = memory.createBuffer('ranking times', stampBytes, QUERY_RESOLVE | COPY_SRC);
    return { keys, sorts, resolved };
  };
  try {
    const { result, checked } = memory.guard('Comparing sorts', 'They stay as they are.', make);
    await checked;
    const { keys, sorts, resolved } = result;
    const [a, b] = await Promise.all(sorts.map((sort) => orderOf(device, sort, keys)));
    const isSameOrder = a.every((index, i) => index === b[i]);
    return { isSameOrder, medianMs: await timesOf(device, resolved, sorts, keys, sortsPerTurn, turns) };
  } finally {
    memory.destroyAll();
  }
}

/** Timestamps of all turns: one before and one after each. */
function stampsOf(turns: number, sorts: number): number {
  return 2 * turns * sorts;
}

function randomKeys(memory: GpuMemory, count: number): GPUBuffer {
  let state = 1;
  const keys = Uint32Array.from({ length: count }, () => {
    // A linear congruential generator modulo 2³²; its lower bits repeat soon, and the sort is to see all digits.
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state ^ (state >>> 16);
  });
  const { COPY_SRC, COPY_DST } = GPUBufferUsage;
  const buffer = memory.createBuffer('ranking keys', keys.byteLength, COPY_SRC | COPY_DST);
  memory.device.queue.writeBuffer(buffer, 0, keys);
  return buffer;
}

function orderOf(device: GPUDevice, sort: RadixSort, keys: GPUBuffer): Promise<Uint32Array> {
  const encoder = device.createCommandEncoder({ label: 'ranking order' });
  encoder.copyBufferToBuffer(keys, 0, sort.keys, 0, keys.size);
  const pass = encoder.beginComputePass();
  sort.record(pass);
  pass.end();
  device.queue.submit([encoder.finish()]);
  return readWords(device, sort.order);
}

/** Median GPU time of each of `sorts`, ms, in turns. */
async function timesOf(
  device: GPUDevice,
  resolved: GPUBuffer,
  sorts: readonly RadixSort[],
  keys: GPUBuffer,
  sortsPerTurn: number,
  turns: number,
): Promise<number[]> {
  const count = stampsOf(turns, sorts.length);
  const querySet = device.createQuerySet({ type: 'timestamp', count });
  try {
    for (let turn = 0; turn < turns; turn++) {
      for (const [i, sort] of sorts.entries()) {
        const at = 2 * (turn * sorts.length + i);
        const encoder = device.createCommandEncoder({ label: 'ranking times' });
        encoder.copyBufferToBuffer(keys, 0, sort.keys, 0, keys.size);
        const timestampWrites = { querySet, beginningOfPassWriteIndex: at, endOfPassWriteIndex: at + 1 };
        const pass = encoder.beginComputePass({ timestampWrites });
        for (let repeat = 0; repeat < sortsPerTurn; repeat++) sort.record(pass);
        pass.end();
        if (at === count - 2) encoder.resolveQuerySet(querySet, 0, count, resolved, 0);
        device.queue.submit([encoder.finish()]);
        // Frames that are drawn meanwhile wait for no more than this.
        await device.queue.onSubmittedWorkDone();
      }
    }
    const ns = new BigUint64Array((await readWords(device, resolved)).buffer);
    return sorts.map((_, i) => {
      const ms = Array.from({ length: turns }, (_, turn) => {
        const at = 2 * (turn * sorts.length + i);
        return Number(ns[at + 1] - ns[at]) / 1e6;
      });
      return timeSpread(ms).median;
    });
  } finally {
    querySet.destroy();
  }
}
