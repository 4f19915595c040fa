const BYTES_PER_TIMESTAMP = 8;

/** A device's timestamps: written in order, read together. */
export class Timestamps {
  readonly #device: GPUDevice;
  readonly #querySet: GPUQuerySet;

  constructor(device: GPUDevice, count: number) {
    this.#device = device;
    this.#querySet = device.createQuerySet({ type: 'timestamp', count });
  }

  /** Records a timestamp of the moment at which all that was submitted or recorded before is done. */
  record(encoder: GPUCommandEncoder, index: number): void {
    const timestampWrites = { querySet: this.#querySet, endOfPassWriteIndex: index };
    encoder.beginComputePass({ timestampWrites }).end();
  }

  /** Returns the commands that {@link record} a timestamp. */
  commands(index: number): GPUCommandBuffer {
    const encoder = this.#device.createCommandEncoder();
    this.record(encoder, index);
    return encoder.finish();
  }

  /** Resolves with the first `count` timestamps, ns. */
  async read(count: number): Promise<BigUint64Array> {
    const size = count * BYTES_PER_TIMESTAMP;
    const { COPY_SRC, COPY_DST, MAP_READ, QUERY_RESOLVE } = GPUBufferUsage;
    const resolved = this.#device.createBuffer({ size, usage: QUERY_RESOLVE | COPY_SRC });
    const mapped = this.#device.createBuffer({ size, usage: COPY_DST | MAP_READ });
    const encoder = this.#device.createCommandEncoder();
    encoder.resolveQuerySet(this.#querySet, 0, count, resolved, 0);
    encoder.copyBufferToBuffer(resolved, 0, mapped, 0, size);
    this.#device.queue.submit([encoder.finish()]);
    await mapped.mapAsync(GPUMapMode.READ);
    const times = new BigUint64Array(mapped.getMappedRange().slice(0));
    resolved.destroy();
    mapped.destroy();
    return times;
  }
}
