import { GpuLimitError } from '../data/errors.ts';

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

/** Result of work that may allocate, and whether there was memory for it. */
export interface Guarded<Result> {
  readonly result: Result;
  /**
   * Rejects, some time later, with a GpuLimitError if memory was lacking: the result is invalid
   * then, and must be destroyed. Null if nothing was allocated. Need not be awaited.
   */
  readonly checked: Promise<void> | null;
}

/** Work under way that allocates. */
interface Section {
  /** Bytes allocated so far. */
  bytes: number;
  /** Whether the device collects errors. */
  isOpen: boolean;
}

/** Advice if a buffer exceeds the limits of a device, unless `EngineOptions.limitAdvice` is given. */
const LIMIT_ADVICE =
  'Load fewer splats, or let the engine make its own device, with the adapter’s full limits.';

/** The only place that creates buffers and textures, so that every byte is labelled and counted. */
export class GpuMemory {
  readonly device: GPUDevice;
  readonly #whole: GpuMemory | null;
  readonly #root: GpuMemory;
  readonly #budgetBytes: number;
  readonly #limitAdvice: string;
  readonly #bytes = new Map<GPUBuffer | GPUTexture, number>();
  /** Buffers that are about to be mapped. */
  readonly #mapping: WeakMap<GPUBuffer | GPUTexture, Promise<void>>;
  #totalBytes = 0;
  #peakBytes = 0;
  /** Set in the root only: parts use the root's. Null while no `guard` runs. */
  #section: Section | null = null;

  /**
   * @param budgetBytes most bytes that may be held.
   * @param whole parent of this memory, null for a root: see `part`.
   * @param limitAdvice see `EngineOptions`.
   */
  constructor(
    device: GPUDevice,
    budgetBytes = Number.POSITIVE_INFINITY,
    whole: GpuMemory | null = null,
    limitAdvice = LIMIT_ADVICE,
  ) {
    this.device = device;
    this.#budgetBytes = budgetBytes;
    this.#limitAdvice = limitAdvice;
    this.#whole = whole;
    this.#root = whole ? whole.#root : this;
    this.#mapping = whole ? whole.#mapping : new WeakMap();
  }

  /** Returns a child memory: its bytes are counted there and here. */
  part(): GpuMemory {
    return new GpuMemory(this.device, this.#budgetBytes, this, this.#limitAdvice);
  }

  /**
   * Does `work`, which may create buffers and textures, and use them in commands that it submits.
   * If memory is lacking, the device reports it later and refuses the commands. Both errors become
   * one rejection of `checked`.
   *
   * @param subject subject of the error message: "garden", "A frame".
   * @param advice sentence that ends the error message: how to need less memory.
   * @param isAlways whether to check even if `work` allocates nothing, because it uses resources of
   *   an earlier `guard` that is still unchecked.
   * @throws GpuLimitError if a buffer cannot be mapped for lack of memory, or would exceed the
   *   budget; the errors of `work`.
   */
  guard<Result>(subject: string, advice: string, work: () => Result, isAlways = false): Guarded<Result> {
    const root = this.#root;
    const outer = root.#section;
    const section: Section = { bytes: 0, isOpen: false };
    const heldBytes = root.#totalBytes;
    const lackOf = (cause: unknown) => {
      const message = `${subject} needs ${section.bytes} bytes more of the GPU's memory, which lacks them; ${heldBytes} are held here. ${advice}`;
      return new GpuLimitError('memory', section.bytes, 0, message, { heldBytes, cause });
    };
    let result: Result;
    let checked: Promise<void> | null = null;
    root.#section = section;
    if (isAlways) root.#open(section);
    try {
      result = work();
    } catch (error) {
      // Thrown by `createBuffer` if it finds no memory for the mapping at creation.
      throw error instanceof RangeError ? lackOf(error) : error;
    } finally {
      root.#section = outer;
      if (section.isOpen) checked = root.#close(lackOf);
    }
    return { result, checked };
  }

  /** Bytes that the budget has left. */
  get availableBytes(): number {
    return this.#budgetBytes - this.#root.#totalBytes;
  }

  /** Bytes held by the root, all of its parts included. */
  get heldBytes(): number {
    return this.#root.#totalBytes;
  }

  /** @throws GpuLimitError, before anything is allocated, if the buffer would exceed limits or budget. */
  createBuffer(
    label: string,
    bytes: number,
    usage: GPUBufferUsageFlags,
    mappedAtCreation = false,
  ): GPUBuffer {
    const size = sizeOf(bytes);
    this.check(label, size, usage);
    this.#begin(label, size);
    return this.#counted(this.device.createBuffer({ label, size, usage, mappedAtCreation }), size);
  }

  /** Creates a storage buffer that holds `words`, and can be read back and overwritten. */
  createFilledBuffer(label: string, words: Uint32Array): GPUBuffer {
    const { STORAGE, COPY_SRC, COPY_DST } = GPUBufferUsage;
    const usage = STORAGE | COPY_SRC | COPY_DST;
    const size = sizeOf(words.byteLength);
    this.check(label, size, usage);
    this.#begin(label, size);
    // Mapped at creation: data goes straight to the driver's staging memory, not copied twice.
    const buffer = this.device.createBuffer({ label, size, usage, mappedAtCreation: true });
    new Uint32Array(buffer.getMappedRange()).set(words);
    buffer.unmap();
    return this.#counted(buffer, size);
  }

  createTexture(
    descriptor: GPUTextureDescriptor & { readonly size: { width: number; height: number } },
  ): GPUTexture {
    const { width, height } = descriptor.size;
    const bytes = width * height * (BYTES_PER_PIXEL[descriptor.format] ?? 4);
    this.#begin(descriptor.label ?? 'texture', bytes);
    return this.#counted(this.device.createTexture(descriptor), bytes);
  }

  /** Creates a texture to draw into and to read later, by shaders or the CPU; `usage` is added. */
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

  /** Maps all of a buffer. `destroy` waits for a pending map. Rejections need no handling. */
  map(buffer: GPUBuffer, mode: GPUMapModeFlags): Promise<void> {
    const mapping = buffer.mapAsync(mode);
    this.#mapping.set(buffer, mapping);
    const end = () => this.#mapping.delete(buffer);
    mapping.then(end, end);
    return mapping;
  }

  /** Destroys a resource, after its map if one is pending, and no longer counts it. */
  destroy(resource: GPUBuffer | GPUTexture): void {
    this.#forget(resource);
    const destroy = () => resource.destroy();
    const mapping = this.#mapping.get(resource);
    // Dawn's bindings for Node 0.6.2 may reject a map twice if its buffer is destroyed, and crash.
    if (mapping) mapping.then(destroy, destroy);
    else destroy();
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
      `${label} needs ${bytes} bytes in one buffer and this device allows ${availableBytes} (${limit}). ${this.#limitAdvice}`,
    );
  }

  /** Checks the budget before an allocation, and begins to collect the device's errors. */
  #begin(label: string, bytes: number): void {
    const root = this.#root;
    const section = root.#section;
    if (section) {
      section.bytes += bytes;
      root.#open(section);
    }
    const { availableBytes, heldBytes } = this;
    if (bytes <= availableBytes) return;
    const message = `${label} needs ${bytes} bytes, and ${heldBytes} of ${this.#budgetBytes} (memoryBudgetBytes) are held. Load fewer splats, draw a smaller image, or allow more.`;
    throw new GpuLimitError('memoryBudgetBytes', bytes, Math.max(0, availableBytes), message, { heldBytes });
  }

  #open(section: Section): void {
    if (section.isOpen) return;
    section.isOpen = true;
    // Commands that use buffers without memory are invalid too: collect their errors as well.
    this.device.pushErrorScope('validation');
    this.device.pushErrorScope('out-of-memory');
  }

  #close(lackOf: (cause: unknown) => GpuLimitError): Promise<void> {
    const errors = [this.device.popErrorScope(), this.device.popErrorScope()];
    const check = async () => {
      // A lost device does not answer, and its loss ends all work anyway.
      const [lacking, invalid] = await Promise.all(errors).catch(() => []);
      if (lacking) throw lackOf(lacking);
      if (invalid) throw new Error(invalid.message);
    };
    const checked = check();
    // Some callers await it only after their own work, and some not at all if that fails.
    checked.catch(() => {});
    return checked;
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
