import { GpuMemory } from '../gpu/gpu-memory.ts';
import { Pipelines } from '../gpu/pipelines.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { COPY_ROW, COPY_WORKGROUP, copyWords } from '../stages/measure/measure.ts';
import { timeSpread } from './time-spread.ts';

/** Options of `measureCopyBandwidth`. */
export interface CopyBandwidthOptions {
  /** Bytes of each copy, a multiple of 16; default 256 MiB, more than caches of today's GPUs. */
  readonly bytes?: number;
  /** Samples whose median counts; default 7. */
  readonly samples?: number;
}

const DEFAULT_BYTES = 256 * 2 ** 20;
const DEFAULT_SAMPLES = 7;
/** A sample repeats the copy for this long, ms: far longer than the latency of a submission varies. */
const SAMPLE_MS = 50;
const MOST_COPIES = 2 ** 13;

/**
 * Measures how many bytes per second the device moves when a shader copies one large buffer into
 * another: bytes read plus bytes written. (`copyBufferToBuffer` moved a quarter of them on an H200.)
 * Allocates two buffers of `bytes` and frees them. Uses the wall clock, so that devices without
 * timestamps can be compared. The time of one copy is subtracted from the time of many, which
 * removes the cost of the submission.
 *
 * @throws GpuLimitError if there is no memory for them.
 * @example
 * const bytesPerSecond = await measureCopyBandwidth(engine.device);
 * console.log(`${Math.round(bytesPerSecond / 1e9)} GB/s`);
 */
export async function measureCopyBandwidth(
  device: GPUDevice,
  { bytes = DEFAULT_BYTES, samples = DEFAULT_SAMPLES }: CopyBandwidthOptions = {},
): Promise<number> {
  // Not the engine's memory: its peak would include these buffers.
  const memory = new GpuMemory(device);
  const pipelines = new Pipelines(device);
  const { maxBufferSize, maxStorageBufferBindingSize } = device.limits;
  try {
    const size = 16 * Math.floor(Math.min(bytes, maxBufferSize, maxStorageBufferBindingSize) / 16);
    const advice = 'Copy fewer bytes, or measure with less loaded.';
    const { result, checked } = memory.guard('Measuring the bandwidth', advice, () =>
      ['a', 'b'].map((name) => memory.createBuffer(`copy ${name}`, size, GPUBufferUsage.STORAGE)),
    );
    const [a, b] = result;
    await checked;
    await pipelines.prepare([copyWords]);
    const pipeline = pipelines.compute(copyWords)!;
    const groups = [
      pipelines.bindGroup(copyWords, { wordsIn: a, wordsOut: b }),
      pipelines.bindGroup(copyWords, { wordsIn: b, wordsOut: a }),
    ];
    const workgroups = dispatchSize(Math.ceil(size / 16 / COPY_WORKGROUP), COPY_ROW);
    const copyMs = async (copies: number) => {
      const encoder = device.createCommandEncoder({ label: 'copy bandwidth' });
      const pass = encoder.beginComputePass({ label: 'copy bandwidth' });
      pass.setPipeline(pipeline);
      for (let i = 0; i < copies; i++) {
        pass.setBindGroup(0, groups[i % 2]);
        pass.dispatchWorkgroups(...workgroups);
      }
      pass.end();
      const commands = encoder.finish();
      const startedMs = performance.now();
      device.queue.submit([commands]);
      await device.queue.onSubmittedWorkDone();
      return performance.now() - startedMs;
    };
    // Warm-up: the first copy touches memory that the driver may allocate lazily.
    await copyMs(2);
    // Doubled until it takes SAMPLE_MS. Not predicted by one copy, whose time is mostly submission overhead.
    let copies = 2;
    while (copies < MOST_COPIES && (await copyMs(copies)) < SAMPLE_MS) copies *= 2;
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
