import { SortParameters, SortPlan } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../pipelines.ts';
import { dispatchAtMost, dispatchSize, type IndirectArguments } from './dispatch.ts';
import { planSort } from './plan-sort.ts';
import { sortHistogram } from './sort-histogram.ts';
import { scanLanesFor, scanWorkgroups, sortScan } from './sort-scan.ts';
import { sortScatter } from './sort-scatter.ts';
import { blockKeysOf, type SortShape } from './sort-shape.ts';

/** Payloads and outputs of a sort, beside its size. */
export type RadixSortOptions = SortSize & {
  readonly shape: SortShape;
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
};

/** The number of keys, on the GPU. */
type SortSize =
  | {
      /** One word: the number of keys. */
      readonly keyCount: GPUBuffer;
      readonly plan?: undefined;
    }
  | {
      /** A `SortPlan` that the caller writes: plan-sort does not run. */
      readonly plan: GPUBuffer;
      /** Dispatch over the plan's blocks; default a workgroup for each block of `capacity` keys. */
      readonly blockDispatch?: IndirectArguments;
    };

/** Lists all stages that such a sort runs. */
export function radixSortStages(
  shape: SortShape,
  {
    plans = true,
    firstCounts = 'counted',
  }: { readonly plans?: boolean } & Pick<RadixSortOptions, 'firstCounts'> = {},
): StageDefinition[] {
  const counts = shape.passes > 1 || firstCounts === 'counted';
  return [
    ...(plans ? [planSort(blockKeysOf(shape))] : []),
    ...(counts ? [sortHistogram(shape)] : []),
    sortScan(shape),
    sortScatter(shape),
  ];
}

interface SortPass {
  /** Null where the counts are given. */
  readonly histogramGroup: GPUBindGroup | null;
  readonly scanGroup: GPUBindGroup;
  readonly scatterGroup: GPUBindGroup;
}

/**
 * A stable least-significant-digit radix sort, reduce-then-scan. Each pass takes three dispatches:
 * a histogram of each block, a scan of each digit's counts over all blocks, and a scatter. No
 * workgroup waits for another, and the number of keys never leaves the GPU.
 *
 * Source: the paper, "A Wait-Free Radix Sort".
 */
export class RadixSort {
  readonly shape: SortShape;
  /** Keys to sort, written by the caller; sorting overwrites them. */
  readonly keys: GPUBuffer;
  /** Payloads by key, written by the caller if they are given; sorting overwrites them. */
  readonly payloads: GPUBuffer;
  /** Where the caller writes both. */
  readonly input: { readonly keys: GPUBufferBinding; readonly payloads: GPUBufferBinding };
  /** After `record`: the payloads in ascending order of keys, equal keys in given order. */
  readonly order: GPUBuffer;
  /** After `record`: the keys in ascending order; null if they are not written. */
  readonly sortedKeys: GPUBuffer | null;
  /** Number of keys per digit and block: all blocks of digit 0, then all blocks of digit 1, … */
  readonly digitCounts: GPUBuffer;
  readonly #pipelines: Pipelines;
  readonly #memory: GpuMemory;
  readonly #planStage: StageDefinition;
  readonly #histogramStage: StageDefinition;
  readonly #scanStage: StageDefinition;
  readonly #scatterStage: StageDefinition;
  readonly #maxBlocks: number;
  readonly #dispatchRow: number;
  readonly #scanLanes: number;
  /** Null where the plan is given. */
  readonly #planGroup: GPUBindGroup | null;
  /** Null where every block there is room for is dispatched. */
  readonly #blockDispatch: IndirectArguments | null;
  readonly #passes: SortPass[];

  /**
   * @param memory a part of its own, whose owner frees it.
   * @throws GpuLimitError if a buffer would exceed the limits.
   */
  constructor(device: GPUDevice, pipelines: Pipelines, memory: GpuMemory, options: RadixSortOptions) {
    const { shape, capacity, dispatchRow, writesKeys = false, label = 'sort' } = options;
    const { payloads: payloadKind = 'index', firstCounts = 'counted' } = options;
    this.shape = shape;
    this.#planStage = planSort(blockKeysOf(shape));
    this.#histogramStage = sortHistogram(shape);
    this.#scanStage = sortScan(shape);
    this.#scatterStage = sortScatter(shape);
    this.#pipelines = pipelines;
    this.#memory = memory;
    const radix = 2 ** shape.digitBits;
    this.#maxBlocks = Math.ceil(capacity / blockKeysOf(shape));
    this.#dispatchRow = dispatchRow;
    this.#scanLanes = scanLanesFor(this.#maxBlocks);

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
    const digitCounts = this.#buffer(`${label} digit counts`, 4 * radix * this.#maxBlocks);
    const digitTotals = this.#buffer(`${label} digit totals`, 4 * radix);
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
        digitShift: pass * shape.digitBits,
        capacity,
        dispatchRow,
        makesPayloads: Number(pass === 0 && payloadKind === 'index'),
        writesKeys: Number(writesKeys || pass < shape.passes - 1),
        scanLanes: this.#scanLanes,
      });
      device.queue.writeBuffer(buffer, 0, contents);
      return buffer;
    });
    let plan: GPUBuffer;
    if (options.plan) {
      plan = options.plan;
      this.#planGroup = null;
      this.#blockDispatch = options.blockDispatch ?? null;
    } else {
      plan = this.#buffer(`${label} plan`, SortPlan.bytes);
      const blockDispatch = this.#buffer(`${label} block dispatch`, 12, GPUBufferUsage.INDIRECT);
      const bindings = { parameters: parameters[0], keyCount: options.keyCount, plan, blockDispatch };
      this.#planGroup = pipelines.bindGroup(this.#planStage, bindings);
      this.#blockDispatch = { buffer: blockDispatch, offset: 0 };
    }
    this.#passes = parameters.map((passParameters, pass) => {
      const [from, to] = [pass % 2, (pass + 1) % 2];
      const shared = { parameters: passParameters, plan, digitTotals };
      const isCounted = pass > 0 || firstCounts === 'counted';
      const histogramBindings = { ...shared, keys: keys[from], digitCounts };
      return {
        histogramGroup: isCounted ? pipelines.bindGroup(this.#histogramStage, histogramBindings) : null,
        scanGroup: pipelines.bindGroup(this.#scanStage, { ...shared, digitCounts }),
        scatterGroup: pipelines.bindGroup(this.#scatterStage, {
          ...shared,
          digitOffsets: digitCounts,
          keysIn: keys[from],
          payloadsOut: payloads[to],
          payloadsIn: payloads[from],
          keysOut: keys[to],
        }),
      };
    });
  }

  record(pass: GPUComputePassEncoder): void {
    if (this.#planGroup) {
      this.#set(pass, this.#planStage, this.#planGroup);
      pass.dispatchWorkgroups(1);
    }
    for (const { histogramGroup, scanGroup, scatterGroup } of this.#passes) {
      if (histogramGroup) {
        this.#set(pass, this.#histogramStage, histogramGroup);
        this.#dispatchBlocks(pass);
      }
      this.#set(pass, this.#scanStage, scanGroup);
      const scanning = scanWorkgroups(this.shape, this.#scanLanes);
      pass.dispatchWorkgroups(...dispatchSize(scanning, this.#dispatchRow));
      this.#set(pass, this.#scatterStage, scatterGroup);
      this.#dispatchBlocks(pass);
    }
  }

  #set(pass: GPUComputePassEncoder, stage: StageDefinition, group: GPUBindGroup): void {
    pass.setPipeline(this.#pipelines.compute(stage)!);
    pass.setBindGroup(0, group);
  }

  #dispatchBlocks(pass: GPUComputePassEncoder): void {
    const [bound, row] = [this.#maxBlocks, this.#dispatchRow];
    if (this.#blockDispatch) dispatchAtMost(pass, bound, row, this.#blockDispatch);
    else pass.dispatchWorkgroups(...dispatchSize(Math.max(1, bound), row));
  }

  #buffer(label: string, bytes: number, usage: GPUBufferUsageFlags = 0): GPUBuffer {
    const { STORAGE, COPY_DST, COPY_SRC } = GPUBufferUsage;
    return this.#memory.createBuffer(label, bytes, usage | STORAGE | COPY_DST | COPY_SRC);
  }
}
