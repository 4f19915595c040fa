import { GpuLimitError } from '../errors.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { Chunk } from '../layout/structs.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../packing/geometry.ts';
import { type PackedHarmonics, shWordsPerSplat } from '../packing/harmonics.ts';
import { chunkCountOf, type PackedCloud } from '../packing/packed-cloud.ts';
import type { CloudPrecision, GeometryPrecision, ShPrecision } from '../packing/precision.ts';
import type { ShDegree } from '../splats/splat-set.ts';

/** Precisions that a cloud holds on the GPU, finest first; at degree 0, which needs no planes, `sh` lists all. */
export interface HeldPrecisions {
  readonly geometry: readonly GeometryPrecision[];
  readonly sh: readonly ShPrecision[];
}

/** Whether both planes of a precision are held. */
export function isHeld(
  { geometry, sh }: HeldPrecisions,
  { geometryPrecision, shPrecision }: CloudPrecision,
): boolean {
  return geometry.includes(geometryPrecision) && sh.includes(shPrecision);
}

/** A part of a cloud that fits the device's bindings. */
export interface CloudPage {
  readonly splatCount: number;
  readonly chunkCount: number;
  readonly geometry: GPUBuffer;
  /** Null at degree 0. */
  readonly shRest: GPUBuffer | null;
  readonly chunks: GPUBuffer;
}

/** One geometry plane and one plane of spherical harmonics of a cloud, page by page. The same object while both exist. */
export interface CloudPages extends CloudPrecision {
  readonly pages: readonly CloudPage[];
}

/** One buffer per page; at degree 0 a plane of spherical harmonics has none. */
export type Plane = readonly GPUBuffer[];

/** Splats of one page, in the cloud's storage order. */
export interface PageRange {
  readonly start: number;
  readonly end: number;
}

const GEOMETRY_FINEST_FIRST: readonly GeometryPrecision[] = ['f32', 'packed'];
const SH_FINEST_FIRST: readonly ShPrecision[] = ['f32', 'f16', 'u8'];

/** Whether `held` is as fine as `wanted`, or finer. */
export function isGeometryAsFine(held: GeometryPrecision, wanted: GeometryPrecision): boolean {
  return GEOMETRY_FINEST_FIRST.indexOf(held) <= GEOMETRY_FINEST_FIRST.indexOf(wanted);
}

export function isShAsFine(held: ShPrecision, wanted: ShPrecision): boolean {
  return SH_FINEST_FIRST.indexOf(held) <= SH_FINEST_FIRST.indexOf(wanted);
}

type DeviceLimits = Pick<GPUSupportedLimits, 'maxBufferSize' | 'maxStorageBufferBindingSize'>;

/** Splats per page: as many whole chunks as fit one binding; 0 if not even one fits. */
export function splatsPerPage(limits: DeviceLimits, bytesPerSplat: number): number {
  return CHUNK_SPLATS * Math.floor(bindingBytes(limits) / (bytesPerSplat * CHUNK_SPLATS));
}

/**
 * Bytes per splat of the largest plane that a cloud of this degree may have. All planes are paged by it, so that any
 * geometry plane matches any plane of spherical harmonics page by page, and planes made later fit the device's bindings too.
 */
export function largestPlaneBytes(degree: ShDegree): number {
  return 4 * Math.max(GEOMETRY_WORDS.f32, shWordsPerSplat(degree, 'f32'));
}

/** Returns the precision in `held` that is nearest to `wanted`: the same, else the next finer, else the finest. */
export function nearestPrecision<Precision>(
  held: readonly Precision[],
  wanted: Precision,
  finestFirst: readonly Precision[],
): Precision {
  const fineEnough = finestFirst.slice(0, finestFirst.indexOf(wanted) + 1).reverse();
  return [...fineEnough, ...finestFirst].find((precision) => held.includes(precision))!;
}

/** The GPU buffers of one cloud, in each precision that it holds. */
export class CloudPlanes {
  readonly shDegree: ShDegree;
  /** Pages of every plane. */
  readonly ranges: readonly PageRange[];
  readonly #memory: GpuMemory;
  readonly #name: string;
  readonly #chunks: Plane;
  readonly #geometry = new Map<GeometryPrecision, Plane>();
  readonly #sh = new Map<ShPrecision, Plane>();
  /** `CloudPages` by their two precisions. */
  readonly #pages = new Map<string, CloudPages>();
  #held: HeldPrecisions | null = null;

  /**
   * Uploads `packed`.
   *
   * @throws GpuLimitError, before anything is allocated, if a chunk of the largest plane cannot be bound.
   */
  constructor(memory: GpuMemory, limits: DeviceLimits, packed: PackedCloud, name: string) {
    this.#memory = memory;
    this.#name = name;
    this.shDegree = packed.harmonics.degree;
    this.ranges = pageRanges(packed.count, pageSplats(limits, this.shDegree, name));
    const chunkWords = Chunk.bytes / 4;
    const chunks = new Uint32Array(packed.chunks);
    this.#chunks = this.ranges.map(({ start, end }, page) => {
      const first = start / CHUNK_SPLATS;
      const words = chunks.subarray(first * chunkWords, (first + chunkCountOf(end - start)) * chunkWords);
      return memory.createFilledBuffer(`${name} chunks ${page}`, words);
    });
    this.#geometry.set(packed.geometry.precision, this.uploadGeometry(packed.geometry));
    if (this.shDegree === 0) for (const precision of SH_FINEST_FIRST) this.#sh.set(precision, []);
    else this.#sh.set(packed.harmonics.precision, this.uploadSh(packed.harmonics));
  }

  /** Precisions of the planes; the same object until a plane is added or freed. */
  get held(): HeldPrecisions {
    this.#held ??= {
      geometry: GEOMETRY_FINEST_FIRST.filter((precision) => this.#geometry.has(precision)),
      sh: SH_FINEST_FIRST.filter((precision) => this.#sh.has(precision)),
    };
    return this.#held;
  }

  get bytes(): number {
    const planes = [this.#chunks, ...this.#geometry.values(), ...this.#sh.values()];
    return planes.flat().reduce((sum, { size }) => sum + size, 0);
  }

  /**
   * Returns the planes to draw for `wanted`: for geometry and for harmonics, the same precision, else the next finer one
   * held, else the finest.
   */
  pagesFor(wanted: CloudPrecision): CloudPages {
    const { geometry, sh } = this.held;
    const geometryPrecision = nearestPrecision(geometry, wanted.geometryPrecision, GEOMETRY_FINEST_FIRST);
    const shPrecision = nearestPrecision(sh, wanted.shPrecision, SH_FINEST_FIRST);
    const key = `${geometryPrecision} ${shPrecision}`;
    const pages = this.#pages.get(key) ?? this.#pagesOf({ geometryPrecision, shPrecision });
    this.#pages.set(key, pages);
    return pages;
  }

  geometryPlane(precision: GeometryPrecision): Plane | undefined {
    return this.#geometry.get(precision);
  }

  shPlane(precision: ShPrecision): Plane | undefined {
    return this.#sh.get(precision);
  }

  /** Uploads a plane that is not part of the cloud yet: adopt it, or free it. */
  uploadGeometry({ precision, words }: PackedGeometry): Plane {
    return this.#upload(words, GEOMETRY_WORDS[precision], 'geometry');
  }

  uploadSh({ words, wordsPerSplat }: PackedHarmonics): Plane {
    return this.#upload(words, wordsPerSplat, 'spherical harmonics');
  }

  /** Creates an empty plane for the GPU to fill. */
  createGeometry(precision: GeometryPrecision): Plane {
    return this.#create(GEOMETRY_WORDS[precision], 'geometry');
  }

  createSh(precision: ShPrecision): Plane {
    return this.#create(shWordsPerSplat(this.shDegree, precision), 'spherical harmonics');
  }

  /** Makes `plane` part of the cloud, or frees it if the cloud already holds its precision. */
  adoptGeometry(precision: GeometryPrecision, plane: Plane): void {
    this.#adopt(this.#geometry, precision, plane);
  }

  adoptSh(precision: ShPrecision, plane: Plane): void {
    this.#adopt(this.#sh, precision, plane);
  }

  /** Frees all planes except those of `claims`. */
  keepOnly(claims: readonly CloudPrecision[]): void {
    for (const [precision, plane] of this.#geometry) {
      if (claims.some(({ geometryPrecision }) => geometryPrecision === precision)) continue;
      this.#drop(this.#geometry, precision, plane);
    }
    for (const [precision, plane] of this.#sh) {
      if (this.shDegree === 0 || claims.some(({ shPrecision }) => shPrecision === precision)) continue;
      this.#drop(this.#sh, precision, plane);
    }
    for (const [key, pages] of this.#pages) if (!isHeld(this.held, pages)) this.#pages.delete(key);
  }

  free(plane: Plane): void {
    for (const buffer of plane) this.#memory.destroy(buffer);
  }

  destroy(): void {
    for (const plane of [this.#chunks, ...this.#geometry.values(), ...this.#sh.values()]) this.free(plane);
  }

  #adopt<Precision>(planes: Map<Precision, Plane>, precision: Precision, plane: Plane): void {
    if (planes.has(precision)) {
      this.free(plane);
      return;
    }
    planes.set(precision, plane);
    this.#held = null;
  }

  #drop<Precision>(planes: Map<Precision, Plane>, precision: Precision, plane: Plane): void {
    this.free(plane);
    planes.delete(precision);
    this.#held = null;
  }

  #pagesOf(precision: CloudPrecision): CloudPages {
    const geometry = this.#geometry.get(precision.geometryPrecision)!;
    const sh = this.#sh.get(precision.shPrecision)!;
    const pages = this.ranges.map(({ start, end }, page) => ({
      splatCount: end - start,
      chunkCount: chunkCountOf(end - start),
      geometry: geometry[page],
      shRest: sh[page] ?? null,
      chunks: this.#chunks[page],
    }));
    return { ...precision, pages };
  }

  #upload(words: Uint32Array, wordsPerSplat: number, what: string): Plane {
    return this.#planeOf(({ start, end }, page) =>
      this.#memory.createFilledBuffer(
        `${this.#name} ${what} ${page}`,
        words.subarray(start * wordsPerSplat, end * wordsPerSplat),
      ),
    );
  }

  #create(wordsPerSplat: number, what: string): Plane {
    return this.#planeOf(({ start, end }, page) => {
      const bytes = 4 * wordsPerSplat * (end - start);
      return this.#memory.createBuffer(`${this.#name} ${what} ${page}`, bytes, GPUBufferUsage.STORAGE);
    });
  }

  /** Makes a buffer per page. If one fails, it frees the others. */
  #planeOf(make: (range: PageRange, page: number) => GPUBuffer): Plane {
    const made: GPUBuffer[] = [];
    try {
      for (const [page, range] of this.ranges.entries()) made.push(make(range, page));
      return made;
    } catch (error) {
      this.free(made);
      throw error;
    }
  }
}

function bindingBytes(limits: DeviceLimits): number {
  return Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize);
}

function pageSplats(limits: DeviceLimits, degree: ShDegree, name: string): number {
  const bytesPerSplat = largestPlaneBytes(degree);
  const splats = splatsPerPage(limits, bytesPerSplat);
  if (splats > 0) return splats;
  const needed = bytesPerSplat * CHUNK_SPLATS;
  const available = bindingBytes(limits);
  const message = `${name} needs bindings of at least ${needed} bytes and this device allows ${available}.`;
  throw new GpuLimitError('maxStorageBufferBindingSize', needed, available, message);
}

function pageRanges(count: number, pageSize: number): PageRange[] {
  return Array.from({ length: Math.ceil(count / pageSize) }, (_, page) => ({
    start: page * pageSize,
    end: Math.min(count, (page + 1) * pageSize),
  }));
}
