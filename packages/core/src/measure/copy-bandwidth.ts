import { GpuMemory } from '../gpu/gpu-memory.ts';
import { timeSpread } from './time-spread.ts';

export interface CopyBandwidthOptions {
  /** Bytes of each copy, a multiple of 4; default 128 MiB, which is more than the caches of today's GPUs hold. */
  readonly bytes?: number;
  /** Samples whose median counts; default 7. */
  readonly samples?: number;
}

const DEFAULT_BYTES = 128 * 2 ** 20;
const DEFAULT_SAMPLES = 7;
/** A sample repeats the copy until it takes about this long: far longer than a submission and the answer to it vary. */
const SAMPLE_MS = 50;
const MOST_COPIES = 256;

/**
 * Measures how many bytes per second the device moves when it copies one large buffer into another: bytes read plus bytes
 * written. Allocates two buffers of that size and frees them. Measured by the wall clock, so that devices without timestamps
 * can be compared: a sample of one copy is taken off each sample of many, and what both spend besides copying drops out.
 */
export async function measureCopyBandwidth(
  device: GPUDevice,
  { bytes = DEFAULT_BYTES, samples = DEFAULT_SAMPLES }: CopyBandwidthOptions = {},
): Promise<number> {
  // Not the engine's memory, whose peak would count these.
  const memory = new GpuMemory(device);
  const { COPY_SRC, COPY_DST } = GPUBufferUsage;
  try {
    const size = Math.min(bytes, device.limits.maxBufferSize);
    const [a, b] = ['a', 'b'].map((name) => memory.createBuffer(`copy ${name}`, size, COPY_SRC | COPY_DST));
    const copyMs = async (copies: number) => {
      const encoder = device.createCommandEncoder({ label: 'copy bandwidth' });
      for (let i = 0; i < copies; i++) {
        const [source, target] = i % 2 === 0 ? [a, b] : [b, a];
        encoder.copyBufferToBuffer(source, 0, target, 0, size);
      }
      const commands = encoder.finish();
      const startedMs = performance.now();
      device.queue.submit([commands]);
      await device.queue.onSubmittedWorkDone();
      return performance.now() - startedMs;
    };
    // The first touches memory that the driver may not have given yet.
    await copyMs(2);
    const copies = Math.min(MOST_COPIES, Math.max(2, Math.round(SAMPLE_MS / (await copyMs(1)))));
    const eachMs: number[] = [];
    for (let sample = 0; sample < samples; sample++) {
      const oneMs = await copyMs(1);
      const manyMs = await copyMs(copies);
      // Copies too short for the clock: then all of the time counts, which is an upper bound.
      eachMs.push(manyMs > oneMs ? (manyMs - oneMs) / (copies - 1) : manyMs / copies);
    }
    return (2 * size) / (timeSpread(eachMs).median / 1000);
  } finally {
    memory.destroyAll();
  }
}
