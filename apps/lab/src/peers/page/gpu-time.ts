import { Timestamps } from './timestamps.ts';

/** Most GPU submissions of a frame that can be timed; more are an error. */
const MOST_SUBMISSIONS = 256;

/**
 * GPU time of all submissions to a device, by any code on the page: each gets a timestamp before its
 * commands and one after them. Queue writes (`writeBuffer`, `writeTexture`) are not timed.
 */
export class GpuTime {
  readonly #device: GPUDevice;
  readonly #timestamps: Timestamps;
  #isOn = false;
  #submissions = 0;

  private constructor(device: GPUDevice) {
    this.#device = device;
    this.#timestamps = new Timestamps(device, 2 * MOST_SUBMISSIONS);
  }

  /** Returns null for devices without timestamps. */
  static of(device: GPUDevice): GpuTime | null {
    return device.features.has('timestamp-query') ? new GpuTime(device) : null;
  }

  /** Returns the commands of a submission, between timestamps while a frame is timed. */
  around(queue: GPUQueue, submitted: Iterable<GPUCommandBuffer>): Iterable<GPUCommandBuffer> {
    if (!this.#isOn || queue !== this.#device.queue) return submitted;
    const commands = [...submitted];
    // Waiting may poke the queue by submissions of nothing, any number of them.
    if (commands.length === 0) return commands;
    const first = 2 * this.#submissions++;
    return [this.#timestamp(first), ...commands, this.#timestamp(first + 1)];
  }

  /** Returns milliseconds of all that `draw` submits. @throws Error if that is too much. */
  async timeMs(draw: () => Promise<void>): Promise<number> {
    this.#submissions = 0;
    this.#isOn = true;
    await draw().finally(() => {
      this.#isOn = false;
    });
    const count = 2 * this.#submissions;
    if (count === 0) return 0;
    if (count > 2 * MOST_SUBMISSIONS)
      throw new Error(`A frame has more than ${MOST_SUBMISSIONS} submissions.`);
    const times = await this.#timestamps.read(count);
    let elapsedNs = 0n;
    for (let at = 0; at < count; at += 2) elapsedNs += times[at + 1] - times[at];
    return Number(elapsedNs) / 1e6;
  }

  #timestamp(index: number): GPUCommandBuffer {
    return this.#timestamps.commands(Math.min(index, 2 * MOST_SUBMISSIONS - 1));
  }
}
