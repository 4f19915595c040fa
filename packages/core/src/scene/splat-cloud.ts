import { GpuLimitError } from '../errors.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { GEOMETRY_WORDS, type LogScaleRange } from '../layout/geometry.ts';
import type { ShPrecision } from '../layout/sh-rest.ts';
import { Chunk } from '../layout/structs.ts';
import type { Vec3 } from '../math/mat4.ts';
import { type Bounds, chunkCountOf, type PackedCloud } from './packed-cloud.ts';
import type { DropCounts, ShDegree } from './splat-set.ts';

/** A part of a cloud that fits the device's bindings. */
export interface CloudPage {
  readonly splatCount: number;
  readonly chunkCount: number;
  readonly geometry: GPUBuffer;
  /** Null at degree 0. */
  readonly shRest: GPUBuffer | null;
  readonly chunks: GPUBuffer;
}

/** Splats on the GPU. */
export class SplatCloud {
  /** For messages and labels. */
  readonly name: string;
  readonly count: number;
  readonly shDegree: ShDegree;
  readonly shPrecision: ShPrecision;
  /** Scene-space point, in float64, that positions are stored relative to. */
  readonly origin: Vec3;
  /** Bounds of the centres, scene space. */
  readonly bounds: Bounds;
  /** Bounds without the outermost splats, scene space: what a camera should show of the cloud. */
  readonly robustBounds: Bounds;
  /** Rows of the file that were left out, by reason. */
  readonly dropped: DropCounts;
  /** Each stored splat's row in its file. */
  readonly fileIndices: Uint32Array;
  /** @internal */
  readonly logScaleRange: LogScaleRange;
  /** @internal */
  readonly pages: readonly CloudPage[];
  /** @internal One `Chunk` struct per chunk. */
  readonly chunks: ArrayBuffer;
  readonly #memory: GpuMemory;
  readonly #onDestroyed: () => void;
  #isDestroyed = false;

  /**
   * Uploads `packed`.
   *
   * @param onDestroyed called when the cloud has been destroyed.
   * @throws GpuLimitError, before anything is allocated, where it cannot be bound.
   */
  constructor(
    memory: GpuMemory,
    limits: GPUSupportedLimits,
    packed: PackedCloud,
    name: string,
    onDestroyed: () => void = () => {},
  ) {
    this.name = name;
    this.count = packed.count;
    this.shDegree = packed.shRest.degree;
    this.shPrecision = packed.shRest.precision;
    this.origin = packed.origin;
    this.bounds = packed.bounds;
    this.robustBounds = packed.robustBounds;
    this.dropped = packed.dropped;
    this.fileIndices = packed.fileIndices;
    this.logScaleRange = packed.geometry.logScaleRange;
    this.chunks = packed.chunks;
    this.#memory = memory;
    this.#onDestroyed = onDestroyed;
    this.pages = upload(memory, packed, pageSplats(limits, packed, name), name);
  }

  /** What the cloud takes on the GPU. */
  get bytes(): number {
    return this.pages.reduce(
      (sum, { geometry, shRest, chunks }) => sum + geometry.size + chunks.size + (shRest?.size ?? 0),
      0,
    );
  }

  get isDestroyed(): boolean {
    return this.#isDestroyed;
  }

  /** Frees the GPU memory; pictures already submitted are not affected. */
  destroy(): void {
    if (this.#isDestroyed) return;
    this.#isDestroyed = true;
    for (const { geometry, shRest, chunks } of this.pages) {
      this.#memory.destroy(geometry);
      this.#memory.destroy(chunks);
      if (shRest) this.#memory.destroy(shRest);
    }
    this.#onDestroyed();
  }
}

/** Splats per page: whole chunks, as many as fit one binding; 0 where not even one does. */
export function splatsPerPage(
  limits: Pick<GPUSupportedLimits, 'maxBufferSize' | 'maxStorageBufferBindingSize'>,
  bytesPerSplat: number,
): number {
  return CHUNK_SPLATS * Math.floor(bindingBytes(limits) / (bytesPerSplat * CHUNK_SPLATS));
}

function bindingBytes(
  limits: Pick<GPUSupportedLimits, 'maxBufferSize' | 'maxStorageBufferBindingSize'>,
): number {
  return Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize);
}

function pageSplats(limits: GPUSupportedLimits, { geometry, shRest }: PackedCloud, name: string): number {
  const bytesPerSplat = 4 * Math.max(GEOMETRY_WORDS[geometry.precision], shRest.wordsPerSplat);
  const splats = splatsPerPage(limits, bytesPerSplat);
  if (splats > 0) return splats;
  const needed = bytesPerSplat * CHUNK_SPLATS;
  const available = bindingBytes(limits);
  const message = `${name} needs bindings of at least ${needed} bytes and this device allows ${available}.`;
  throw new GpuLimitError('maxStorageBufferBindingSize', needed, available, message);
}

function upload(memory: GpuMemory, packed: PackedCloud, pageSize: number, name: string): CloudPage[] {
  const { geometry, shRest, chunks, count } = packed;
  const geometryWords = GEOMETRY_WORDS[geometry.precision];
  const chunkWords = Chunk.bytes / 4;
  const chunkData = new Uint32Array(chunks);
  const pages: CloudPage[] = [];
  for (let start = 0; start < count; start += pageSize) {
    const end = Math.min(count, start + pageSize);
    const firstChunk = start / CHUNK_SPLATS;
    const chunkCount = chunkCountOf(end - start);
    const part = (what: string, words: Uint32Array, from: number, to: number) =>
      memory.createFilledBuffer(`${name} ${what} ${pages.length}`, words.subarray(from, to));
    pages.push({
      splatCount: end - start,
      chunkCount,
      geometry: part('geometry', geometry.words, start * geometryWords, end * geometryWords),
      shRest:
        shRest.wordsPerSplat > 0
          ? part(
              'spherical harmonics',
              shRest.words,
              start * shRest.wordsPerSplat,
              end * shRest.wordsPerSplat,
            )
          : null,
      chunks: part('chunks', chunkData, firstChunk * chunkWords, (firstChunk + chunkCount) * chunkWords),
    });
  }
  return pages;
}
