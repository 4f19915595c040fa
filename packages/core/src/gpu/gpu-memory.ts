import { GpuLimitError } from '../errors.ts';

/** Buffers and textures of an engine, or of one of its views. */
export interface GpuMemoryReport {
  readonly totalBytes: number;
  /** Largest `totalBytes` so far. */
  readonly peakBytes: number;
  /** Buffers and textures, largest first. */
  readonly resources: readonly { readonly label: string; readonly bytes: number }[];
}

const BYTES_PER_PIXEL: Partial<Record<GPUTextureFormat, number>> = {
  r16float: 2,
  rgba8unorm: 4,
  rgba16float: 8,
  rgba32float: 16,
};

/** The only place that creates buffers and textures, so that every byte is labelled and counted. */
export class GpuMemory {
  readonly device: GPUDevice;
  readonly #whole: GpuMemory | null;
  readonly #bytes = new Map<GPUBuffer | GPUTexture, number>();
  #totalBytes = 0;
  #peakBytes = 0;

  /** @param whole the memory that this is a part of: see `part`. */
  constructor(device: GPUDevice, whole: GpuMemory | null = null) {
    this.device = device;
    this.#whole = whole;
  }

  /** Returns memory that is counted by itself and here. */
  part(): GpuMemory {
    return new GpuMemory(this.device, this);
  }

  /** @throws GpuLimitError, before anything is allocated, if the buffer would exceed the device's limits. */
  createBuffer(
    label: string,
    bytes: number,
    usage: GPUBufferUsageFlags,
    mappedAtCreation = false,
  ): GPUBuffer {
    const size = sizeOf(bytes);
    this.check(label, size, usage);
    return this.#counted(this.device.createBuffer({ label, size, usage, mappedAtCreation }), size);
  }

  /** Creates a storage buffer with the contents `words`, which can be read back. */
  createFilledBuffer(label: string, words: Uint32Array): GPUBuffer {
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
    const size = sizeOf(words.byteLength);
    this.check(label, size, usage);
    // Mapped at creation: the data goes straight to the driver's staging memory, without a second copy here.
    const buffer = this.device.createBuffer({ label, size, usage, mappedAtCreation: true });
    new Uint32Array(buffer.getMappedRange()).set(words);
    buffer.unmap();
    return this.#counted(buffer, size);
  }

  createTexture(
    descriptor: GPUTextureDescriptor & { readonly size: { width: number; height: number } },
  ): GPUTexture {
    const { width, height } = descriptor.size;
    return this.#counted(
      this.device.createTexture(descriptor),
      width * height * (BYTES_PER_PIXEL[descriptor.format] ?? 4),
    );
  }

  /** Creates a texture to draw into and to read afterwards, by shaders or by the CPU; `usage` is added to that. */
  createTarget(
    label: string,
    format: GPUTextureFormat,
    { width, height }: Pick<GPUTexture, 'width' | 'height'>,
    usage: GPUTextureUsageFlags = 0,
  ): GPUTexture {
    const { RENDER_ATTACHMENT, TEXTURE_BINDING, COPY_SRC } = GPUTextureUsage;
    const all = RENDER_ATTACHMENT | TEXTURE_BINDING | COPY_SRC | usage;
    return this.createTexture({ label, size: { width, height }, format, usage: all });
  }

  /** Returns the bytes of a resource; 0 for null. */
  bytesOf(resource: GPUBuffer | GPUTexture | null | undefined): number {
    return resource ? (this.#bytes.get(resource) ?? 0) : 0;
  }

  destroy(resource: GPUBuffer | GPUTexture): void {
    this.#forget(resource);
    resource.destroy();
  }

  destroyAll(): void {
    for (const resource of [...this.#bytes.keys()]) this.destroy(resource);
  }

  report(): GpuMemoryReport {
    const resources = [...this.#bytes].map(([{ label }, bytes]) => ({ label, bytes }));
    resources.sort((a, b) => b.bytes - a.bytes);
    return { totalBytes: this.#totalBytes, peakBytes: this.#peakBytes, resources };
  }

  /** @throws GpuLimitError if such a buffer would exceed the device's limits. */
  check(label: string, bytes: number, usage: GPUBufferUsageFlags): void {
    const { maxBufferSize, maxStorageBufferBindingSize } = this.device.limits;
    const isStorage = (usage & GPUBufferUsage.STORAGE) !== 0;
    const limit =
      isStorage && maxStorageBufferBindingSize < maxBufferSize
        ? 'maxStorageBufferBindingSize'
        : 'maxBufferSize';
    const availableBytes = this.device.limits[limit];
    if (bytes <= availableBytes) return;
    throw new GpuLimitError(
      limit,
      bytes,
      availableBytes,
      `${label} needs ${bytes} bytes in one buffer and this device allows ${availableBytes} (${limit}). ` +
        'Load fewer splats, or let the engine make its own device, with the adapter’s full limits.',
    );
  }

  #counted<Resource extends GPUBuffer | GPUTexture>(resource: Resource, bytes: number): Resource {
    this.#bytes.set(resource, bytes);
    this.#totalBytes += bytes;
    this.#peakBytes = Math.max(this.#peakBytes, this.#totalBytes);
    if (this.#whole) this.#whole.#counted(resource, bytes);
    return resource;
  }

  #forget(resource: GPUBuffer | GPUTexture): void {
    this.#totalBytes -= this.#bytes.get(resource) ?? 0;
    this.#bytes.delete(resource);
    if (this.#whole) this.#whole.#forget(resource);
  }
}

/** WebGPU cannot bind empty buffers, and copies whole words. */
function sizeOf(bytes: number): number {
  return Math.max(4, Math.ceil(bytes / 4) * 4);
}
