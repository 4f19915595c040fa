import { SortParameters } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { type Dispatch, type DispatchSize, dispatchOf, type IndirectArguments } from '../../gpu/passes.ts';
import type { Bindings, Pipelines, StageDefinition } from '../../gpu/pipelines.ts';
import { dispatchSize, sizeAtMost } from '../dispatch.ts';
import { sortGather } from '../wide-keys/wide-keys.ts';
import {
  blockKeysOf,
  lowerPassesOf,
  type SortShape,
  scanLanesFor,
  scanWorkgroups,
  sortHistogram,
  sortScan,
  sortScatter,
} from './sort.ts';

export interface RadixSortOptions {
  readonly shape: SortShape;
  /** A `SortPlan` that the caller writes: how many keys there are. */
  readonly plan: GPUBuffer;
  /** Dispatch over the plan's blocks; default a workgroup for each block of `capacity` keys. */
  readonly blockDispatch?: IndirectArguments;
  /** Largest number of keys. */
  readonly capacity: number;
  /** Largest number of workgroups in one dimension of a dispatch. */
  readonly dispatchRow: number;
  /** Words sorted by the keys: their indices, or `payloads` of the caller. Default 'index'. */
  readonly payloads?: 'index' | 'given';
  /** Whether `sortedKeys` is written. Default false, which saves half of the last pass's writes. */
  readonly writesKeys?: boolean;
  /**
   * Whether a histogram counts the digits of the first pass, or the caller writes `digitCounts`.
   * Default 'counted'.
   */
  readonly firstCounts?: 'counted' | 'given';
  /**
   * Eight bytes per key, a multiple of 256 keys, that the caller lends for the duration of the
   * sort. It holds the keys and payloads that the result does not: the given ones if the number of
   * passes is odd.
   */
  readonly spare?: GPUBuffer;
  /** Takes the order, four bytes per key; stays the caller's. Default: the sort's own buffer. */
  readonly order?: GPUBuffer;
  /** Begins the labels of the buffers. Default 'sort'. */
  readonly label?: string;
}

/** Lists all stages that a sort of this shape runs. */
export function radixSortStages(
  shape: SortShape,
  { firstCounts = 'counted' }: Pick<RadixSortOptions, 'firstCounts'> = {},
): StageDefinition[] {
  const counts = shape.passes > 1 || firstCounts === 'counted';
  return [
    ...(counts ? [sortHistogram(shape)] : []),
    ...(lowerPassesOf(shape) === null ? [] : [sortGather(shape)]),
    sortScan(shape),
    sortScatter(shape),
  ];
}

/**
 * A stable least-significant-digit radix sort, reduce-then-scan. Each pass takes three dispatches:
 * a histogram of each block, a scan of each digit's counts over all blocks, and a scatter. No
 * workgroup waits for another, and the number of keys never leaves the GPU. Keys of more than 32 bits
 * are sorted by their lower words first; one more dispatch then brings the upper ones into that
 * order.
 *
 * Source: the paper, "A Wait-Free Radix Sort".
 */
export class RadixSort {
  readonly shape: SortShape;
  /** Keys to sort, or their lower words, written by the caller; sorting overwrites them. */
  readonly keys: GPUBuffer;
  /** Upper words of the keys, written by the caller; null if keys have one word. */
  readonly upperKeys: GPUBuffer | null;
  /** Payloads by key, written by the caller if they are given; sorting overwrites them. */
  readonly payloads: GPUBuffer;
  /** Where the caller writes both. */
  readonly input: { readonly keys: GPUBufferBinding; readonly payloads: GPUBufferBinding };
  /** After the sort: the payloads in ascending order of keys, equal keys in given order. */
  readonly order: GPUBuffer;
  /** After the sort: the keys in ascending order; null if they are not written. */
  readonly sortedKeys: GPUBuffer | null;
  /** Number of keys per digit and block: all blocks of digit 0, then all blocks of digit 1, … */
  readonly digitCounts: GPUBuffer;
  /** The sort, to be recorded after its input is written. */
  readonly dispatches: readonly Dispatch[];
  readonly #memory: GpuMemory;

  /**
   * @param memory a part of its own, whose owner frees it.
   * @throws GpuLimitError if a buffer would exceed the limits.
   */
  constructor(device: GPUDevice, pipelines: Pipelines, memory: GpuMemory, options: RadixSortOptions) {
    const { shape, plan, blockDispatch, capacity, dispatchRow } = options;
    const { writesKeys = false, label = 'sort' } = options;
    const { payloads: payloadKind = 'index', firstCounts = 'counted' } = options;
    this.shape = shape;
    this.#memory = memory;
    const radix = 2 ** shape.digitBits;
    const maxBlocks = Math.ceil(capacity / blockKeysOf(shape));
    const scanLanes = scanLanesFor(maxBlocks, shape.isNarrow);

    // A single pass needs no second buffer of keys, nor a first of payloads: neither is used.
    const hasMany = shape.passes > 1;
    const usesKeys = [true, hasMany || writesKeys];
    const usesPayloads = [hasMany || payloadKind === 'given', true];
    const last = shape.passes % 2;
    const { spare } = options;
    const half = { size: 4 * capacity };
    const place = (name: string, isUsed: boolean, i: number, offset: number): GPUBufferBinding =>
      spare && i !== last
        ? { buffer: spare, offset, ...half }
        : { buffer: this.#buffer(`${label} ${name} ${i}`, isUsed ? 4 * capacity : 4) };
    const keys = usesKeys.map((isUsed, i) => place('keys', isUsed, i, 0));
    const payloads = usesPayloads.map((isUsed, i) =>
      options.order && i === last ? { buffer: options.order } : place('payloads', isUsed, i, 4 * capacity),
    );
    const digitCounts = this.#buffer(`${label} digit counts`, 4 * radix * maxBlocks);
    const digitTotals = this.#buffer(`${label} digit totals`, 4 * radix);
    const lowerPasses = lowerPassesOf(shape);
    this.upperKeys = lowerPasses === null ? null : this.#buffer(`${label} upper keys`, 4 * capacity);
    this.keys = keys[0].buffer;
    this.payloads = payloads[0].buffer;
    this.input = { keys: keys[0], payloads: payloads[0] };
    this.order = payloads[last].buffer;
    this.sortedKeys = writesKeys ? keys[last].buffer : null;
    this.digitCounts = digitCounts;

    const parameters = Array.from({ length: shape.passes }, (_, pass) => {
      const buffer = this.#buffer(
        `${label} pass ${pass} parameters`,
        SortParameters.bytes,
        GPUBufferUsage.UNIFORM,
      );
      const contents = SortParameters.pack({
        digitShift: (pass % (lowerPasses ?? shape.passes)) * shape.digitBits,
        capacity,
        dispatchRow,
        makesPayloads: Number(pass === 0 && payloadKind === 'index'),
        // The lower words serve no more after their last pass.
        writesKeys: Number(pass + 1 === shape.passes ? writesKeys : pass + 1 !== lowerPasses),
        scanLanes,
      });
      device.queue.writeBuffer(buffer, 0, contents);
      return buffer;
    });
    const dispatches: Dispatch[] = [];
    const add = (stage: StageDefinition, bindings: Bindings, size: DispatchSize) =>
      dispatches.push(dispatchOf(pipelines, stage, bindings, size));
    const blocks = blockDispatch
      ? sizeAtMost(maxBlocks, dispatchRow, blockDispatch, shape.isNarrow)
      : dispatchSize(Math.max(1, maxBlocks), dispatchRow);
    const scanSize = dispatchSize(scanWorkgroups(shape, scanLanes), dispatchRow);
    const [histogram, scan, scatter] = [sortHistogram(shape), sortScan(shape), sortScatter(shape)];
    for (const [pass, passParameters] of parameters.entries()) {
      const [from, to] = [pass % 2, (pass + 1) % 2];
      const shared = { parameters: passParameters, plan, digitTotals, digitCounts };
      if (this.upperKeys && pass === lowerPasses) {
        const upper = { upperKeys: this.upperKeys, payloads: payloads[from], keys: keys[from] };
        add(sortGather(shape), { parameters: passParameters, plan, ...upper }, blocks);
      }
      if (pass > 0 || firstCounts === 'counted') add(histogram, { ...shared, keys: keys[from] }, blocks);
      add(scan, shared, scanSize);
      const moved = { payloadsIn: payloads[from], payloadsOut: payloads[to], keysOut: keys[to] };
      add(scatter, { ...shared, ...moved, digitOffsets: digitCounts, keysIn: keys[from] }, blocks);
    }
    this.dispatches = dispatches;
  }

  #buffer(label: string, bytes: number, usage: GPUBufferUsageFlags = 0): GPUBuffer {
    const { STORAGE, COPY_DST, COPY_SRC } = GPUBufferUsage;
    return this.#memory.createBuffer(label, bytes, usage | STORAGE | COPY_DST | COPY_SRC);
  }
}
