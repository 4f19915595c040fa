import { SCAN_BLOCK } from '../../data/layout/constants.ts';
import { ScanParameters } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../pipelines.ts';
import { dispatchSize } from './dispatch.ts';

const [reduceBlocks, scanBlocks, scanSingleBlock] = ['reduceBlocks', 'scanBlocks', 'scanSingleBlock'].map(
  (entryPoint): StageDefinition => ({ stage: 'prefix-scan', entryPoint }),
);

export const prefixScanStages: readonly StageDefinition[] = [reduceBlocks, scanBlocks, scanSingleBlock];

interface ScanLevel {
  readonly blockCount: number;
  readonly bindGroup: GPUBindGroup;
}

/** An exclusive prefix scan in place: n counts become n + 1 sums, the total last. */
export class PrefixScan {
  readonly #pipelines: Pipelines;
  readonly #levels: ScanLevel[] = [];
  readonly #dispatchRow: number;

  /**
   * @param memory a part of its own, whose owner frees it.
   * @param values a buffer with room for maxCount + 1 words.
   * @param inputCount one word on the GPU: the number of counts, at most `maxCount`.
   * @throws GpuLimitError
   */
  constructor(
    device: GPUDevice,
    pipelines: Pipelines,
    memory: GpuMemory,
    options: {
      label: string;
      values: GPUBuffer;
      inputCount: GPUBuffer;
      maxCount: number;
      dispatchRow: number;
    },
  ) {
    this.#pipelines = pipelines;
    this.#dispatchRow = options.dispatchRow;
    let { values, inputCount, maxCount } = options;
    const { STORAGE, UNIFORM, COPY_DST } = GPUBufferUsage;
    for (let level = 0; ; level++) {
      const blockCount = Math.ceil((maxCount + 1) / SCAN_BLOCK);
      const label = `${options.label} scan level ${level}`;
      const parameters = memory.createBuffer(`${label} parameters`, ScanParameters.bytes, UNIFORM | COPY_DST);
      const contents = ScanParameters.pack({ blockCount, dispatchRow: options.dispatchRow });
      device.queue.writeBuffer(parameters, 0, contents);
      const blockSums = memory.createBuffer(`${label} block sums`, 4 * (blockCount + 1), STORAGE | COPY_DST);
      const bindGroup = pipelines.bindGroup(reduceBlocks, { parameters, inputCount, values, blockSums });
      this.#levels.push({ blockCount, bindGroup });
      if (blockCount === 1) break;
      // The next level scans this level's block sums; their number never changes.
      values = blockSums;
      maxCount = blockCount;
      inputCount = memory.createBuffer(`${label} block count`, 4, STORAGE | COPY_DST);
      device.queue.writeBuffer(inputCount, 0, Uint32Array.of(blockCount));
    }
  }

  record(pass: GPUComputePassEncoder): void {
    const last = this.#levels.length - 1;
    for (let level = 0; level < last; level++) this.#dispatch(pass, reduceBlocks, level);
    this.#dispatch(pass, scanSingleBlock, last);
    for (let level = last - 1; level >= 0; level--) this.#dispatch(pass, scanBlocks, level);
  }

  #dispatch(pass: GPUComputePassEncoder, stage: StageDefinition, level: number): void {
    const { blockCount, bindGroup } = this.#levels[level];
    pass.setPipeline(this.#pipelines.compute(stage)!);
    pass.setBindGroup(0, bindGroup);
    pass.dispatchWorkgroups(...dispatchSize(blockCount, this.#dispatchRow));
  }
}
