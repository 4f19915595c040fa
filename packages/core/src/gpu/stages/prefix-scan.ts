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
  readonly #memory: GpuMemory;
  readonly #buffers: GPUBuffer[] = [];
  readonly #levels: ScanLevel[] = [];
  readonly #dispatchRow: number;

  /**
   * @param values a buffer with room for maxCount + 1 words.
   * @param inputCount one word on the GPU: the number of counts, at most `maxCount`.
   * @throws GpuLimitError; nothing is left allocated then.
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
    this.#memory = memory;
    this.#dispatchRow = options.dispatchRow;
    let { values, inputCount, maxCount } = options;
    for (let level = 0; ; level++) {
      const blockCount = Math.ceil((maxCount + 1) / SCAN_BLOCK);
      const label = `${options.label} scan level ${level}`;
      const parameters = this.#buffer(`${label} parameters`, ScanParameters.bytes, GPUBufferUsage.UNIFORM);
      const contents = ScanParameters.pack({ blockCount, dispatchRow: options.dispatchRow });
      device.queue.writeBuffer(parameters, 0, contents);
      const blockSums = this.#buffer(`${label} block sums`, 4 * (blockCount + 1), GPUBufferUsage.STORAGE);
      const bindGroup = pipelines.bindGroup(reduceBlocks, { parameters, inputCount, values, blockSums });
      this.#levels.push({ blockCount, bindGroup });
      if (blockCount === 1) break;
      // The next level scans this level's block sums; their number never changes.
      values = blockSums;
      maxCount = blockCount;
      inputCount = this.#buffer(`${label} block count`, 4, GPUBufferUsage.STORAGE);
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

  /** Creates a buffer, or frees those made before it if it cannot be had. */
  #buffer(label: string, bytes: number, usage: GPUBufferUsageFlags): GPUBuffer {
    try {
      const buffer = this.#memory.createBuffer(label, bytes, usage | GPUBufferUsage.COPY_DST);
      this.#buffers.push(buffer);
      return buffer;
    } catch (error) {
      for (const buffer of this.#buffers) this.#memory.destroy(buffer);
      throw error;
    }
  }
}
