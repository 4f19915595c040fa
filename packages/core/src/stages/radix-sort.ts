import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import { SortParameters, SortPlan } from '../layout/structs.ts';
import { dispatchAtMost } from './dispatch.ts';
import { planSort } from './plan-sort.ts';
import { PrefixScan, prefixScanStages } from './prefix-scan.ts';
import { sortHistogram } from './sort-histogram.ts';
import { sortScatter } from './sort-scatter.ts';
import { type SortShape, tileKeysOf } from './sort-shape.ts';

/** Lists all stages that a sort of this shape runs. */
export function radixSortStages(shape: SortShape): StageDefinition[] {
  return [...prefixScanStages, planSort(tileKeysOf(shape)), sortHistogram(shape), sortScatter(shape)];
}

interface SortPass {
  readonly histogramGroup: GPUBindGroup;
  readonly scatterGroup: GPUBindGroup;
}

/**
 * A stable least-significant-digit radix sort, reduce-then-scan: per pass a histogram of each tile, a scan over all
 * histograms, and a scatter. No workgroup waits for another, and the number of keys never leaves the GPU.
 *
 * Source: the paper, "A Wait-Free Radix Sort".
 */
export class RadixSort {
  readonly shape: SortShape;
  /** Keys to sort, written by the caller; sorting overwrites them. */
  readonly keys: GPUBuffer;
  /** After `record`: the index of each key in ascending order of keys, equal keys in their given order. */
  readonly order: GPUBuffer;
  readonly #pipelines: Pipelines;
  readonly #memory: GpuMemory;
  readonly #buffers: GPUBuffer[] = [];
  readonly #planStage: ReturnType<typeof planSort>;
  readonly #histogramStage: ReturnType<typeof sortHistogram>;
  readonly #scatterStage: ReturnType<typeof sortScatter>;
  readonly #maxTiles: number;
  readonly #dispatchRow: number;
  readonly #scan: PrefixScan;
  readonly #planGroup: GPUBindGroup;
  readonly #tileDispatch: GPUBuffer;
  readonly #passes: SortPass[];

  /**
   * @param capacity largest number of keys.
   * @param keyCount one word on the GPU: the number of keys.
   * @param dispatchRow largest number of workgroups in one dimension of a dispatch.
   */
  constructor(
    device: GPUDevice,
    pipelines: Pipelines,
    memory: GpuMemory,
    options: { shape: SortShape; capacity: number; keyCount: GPUBuffer; dispatchRow: number },
  ) {
    const { shape, capacity, keyCount, dispatchRow } = options;
    this.shape = shape;
    this.#planStage = planSort(tileKeysOf(shape));
    this.#histogramStage = sortHistogram(shape);
    this.#scatterStage = sortScatter(shape);
    this.#pipelines = pipelines;
    this.#memory = memory;
    const radix = 1 << shape.digitBits;
    const tileKeys = tileKeysOf(shape);
    this.#maxTiles = Math.ceil(capacity / tileKeys);
    this.#dispatchRow = dispatchRow;
    const maxDigitCounts = radix * this.#maxTiles;

    const keys = [0, 1].map((i) => this.#buffer(`sort keys ${i}`, 4 * capacity));
    const payloads = [0, 1].map((i) => this.#buffer(`sort payloads ${i}`, 4 * capacity));
    const digitCounts = this.#buffer('sort digit counts', 4 * (maxDigitCounts + 1));
    const digitCountCount = this.#buffer('sort digit count count', 4);
    const plan = this.#buffer('sort plan', SortPlan.bytes);
    this.#tileDispatch = this.#buffer('sort tile dispatch', 12, GPUBufferUsage.INDIRECT);
    this.keys = keys[0];
    this.order = payloads[shape.passes % 2];

    this.#scan = new PrefixScan(device, pipelines, memory, {
      label: 'sort',
      values: digitCounts,
      inputCount: digitCountCount,
      maxCount: maxDigitCounts,
      dispatchRow,
    });
    const parameters = Array.from({ length: shape.passes }, (_, pass) => {
      const buffer = this.#buffer(
        `sort pass ${pass} parameters`,
        SortParameters.bytes,
        GPUBufferUsage.UNIFORM,
      );
      const contents = SortParameters.pack({
        digitShift: pass * shape.digitBits,
        radix,
        capacity,
        dispatchRow,
        isFirst: Number(pass === 0),
        isLast: Number(pass === shape.passes - 1),
      });
      device.queue.writeBuffer(buffer, 0, contents);
      return buffer;
    });
    this.#planGroup = pipelines.bindGroup(this.#planStage, {
      parameters: parameters[0],
      keyCount,
      plan,
      digitCountCount,
      tileDispatch: this.#tileDispatch,
    });
    this.#passes = parameters.map((passParameters, pass) => {
      const [from, to] = [pass % 2, (pass + 1) % 2];
      return {
        histogramGroup: pipelines.bindGroup(this.#histogramStage, {
          parameters: passParameters,
          plan,
          keys: keys[from],
          digitCounts,
        }),
        scatterGroup: pipelines.bindGroup(this.#scatterStage, {
          parameters: passParameters,
          plan,
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
    pass.setPipeline(this.#pipelines.compute(this.#planStage)!);
    pass.setBindGroup(0, this.#planGroup);
    pass.dispatchWorkgroups(1);
    const indirect = { buffer: this.#tileDispatch, offset: 0 };
    for (const { histogramGroup, scatterGroup } of this.#passes) {
      pass.setPipeline(this.#pipelines.compute(this.#histogramStage)!);
      pass.setBindGroup(0, histogramGroup);
      dispatchAtMost(pass, this.#maxTiles, this.#dispatchRow, indirect);
      this.#scan.record(pass);
      pass.setPipeline(this.#pipelines.compute(this.#scatterStage)!);
      pass.setBindGroup(0, scatterGroup);
      dispatchAtMost(pass, this.#maxTiles, this.#dispatchRow, indirect);
    }
  }

  destroy(): void {
    this.#scan.destroy();
    for (const buffer of this.#buffers) this.#memory.destroy(buffer);
  }

  #buffer(label: string, bytes: number, usage: GPUBufferUsageFlags = 0): GPUBuffer {
    const buffer = this.#memory.createBuffer(
      label,
      bytes,
      usage | GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC,
    );
    this.#buffers.push(buffer);
    return buffer;
  }
}
