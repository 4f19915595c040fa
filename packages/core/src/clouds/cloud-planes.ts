import { GpuLimitError } from '../data/errors.ts';
import { CHUNK_WORDS } from '../data/layout/chunk-words.ts';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { chunkCountOf } from '../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../data/packing/geometry.ts';
import { paletteWordsOf, type StoredHarmonics, shWordsPerSplat } from '../data/packing/harmonics.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import {
  type CloudPrecision,
  GEOMETRY_PRECISIONS,
  type GeometryPrecision,
  SH_PRECISIONS,
  type ShPrecision,
} from '../data/packing/precision.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import type { PackedMotion } from '../features/motion/pack-motion.data.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';

/**
 * Precisions that a cloud holds on the GPU, finest first. `sh` lists all precisions at degree 0,
 * which needs no planes, and for sources whose harmonics are a palette, which serves every
 * precision.
 */
export interface HeldPrecisions {
  readonly geometry: readonly GeometryPrecision[];
  readonly sh: readonly ShPrecision[];
}

/** Whether the planes of geometry and of harmonics are held in this precision. */
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
  /** Null or absent if the splats stand still. */
  readonly motion?: { readonly splats: GPUBuffer; readonly reaches: GPUBuffer } | null;
}

/** A cloud's planes of geometry and harmonics, by page. The same object while both exist. */
export interface CloudPages extends CloudPrecision {
  readonly pages: readonly CloudPage[];
}

/** GPU memory of one cloud, by planes. */
export interface CloudMemory {
  readonly totalBytes: number;
  readonly geometryBytes: Readonly<Partial<Record<GeometryPrecision, number>>>;
  /** Empty at degree 0. */
  readonly shBytes: Readonly<Partial<Record<ShPrecision, number>>>;
  /** Bounds of the chunks. */
  readonly chunksBytes: number;
  /** How splats and chunks move; absent if they stand still. */
  readonly motionBytes?: number;
}

/** One buffer per page; none for harmonics at degree 0. */
export type Plane = readonly GPUBuffer[];

/** Splats of one page, in the cloud's storage order. */
export interface PageRange {
  readonly start: number;
  readonly end: number;
}

/** Whether `held` is as fine as `wanted`, or finer. */
export function isGeometryAsFine(held: GeometryPrecision, wanted: GeometryPrecision): boolean {
  return GEOMETRY_PRECISIONS.indexOf(held) <= GEOMETRY_PRECISIONS.indexOf(wanted);
}

export function isShAsFine(held: ShPrecision, wanted: ShPrecision): boolean {
  return SH_PRECISIONS.indexOf(held) <= SH_PRECISIONS.indexOf(wanted);
}

type DeviceLimits = Pick<GPUSupportedLimits, 'maxBufferSize' | 'maxStorageBufferBindingSize'>;

/** Splats per page: as many whole chunks as fit one binding; 0 if not even one fits. */
export function splatsPerPage(limits: DeviceLimits, bytesPerSplat: number): number {
  return CHUNK_SPLATS * Math.floor(bindingBytes(limits) / (bytesPerSplat * CHUNK_SPLATS));
}

/**
 * Bytes per splat of the largest plane that a cloud of this degree may have. All planes are paged
 * by it, so that planes made later fit the device's bindings too. Any geometry plane then matches
 * any plane of harmonics page by page.
 */
export function largestPlaneBytes(degree: ShDegree): number {
  return 4 * Math.max(GEOMETRY_WORDS.f32, shWordsPerSplat(degree, 'f32'));
}

/** Returns the precision in `held` nearest to `wanted`: itself, the next finer, or the finest. */
export function nearestPrecision<Precision>(
  held: readonly Precision[],
  wanted: Precision,
  finestFirst: readonly Precision[],
): Precision {
  const fineEnough = finestFirst.slice(0, finestFirst.indexOf(wanted) + 1).reverse();
  return [...fineEnough, ...finestFirst].find((precision) => held.includes(precision))!;
}

/** Planes of one precision, on the GPU. */
export interface MadePlanes extends CloudPrecision {
  readonly shDegree: ShDegree;
  /** Whether the source's own harmonics are a palette; default false. */
  readonly hasOwnPalette?: boolean;
  readonly ranges: readonly PageRange[];
  readonly chunks: Plane;
  readonly geometry: Plane;
  /** Empty at degree 0. */
  readonly harmonics: Plane;
  /** Default: the splats stand still. */
  readonly motion?: MotionPlanes | null;
}

/** How splats move, and how far chunks reach, by page; see `PackedMotion`. */
interface MotionPlanes {
  readonly splats: Plane;
  readonly reaches: Plane;
}

/** The GPU buffers of one cloud, in every precision that it holds. */
export class CloudPlanes {
  readonly shDegree: ShDegree;
  /**
   * Whether the source's own harmonics are a palette. It is then always kept, because nothing is
   * finer.
   */
  readonly hasOwnPalette: boolean;
  /** Pages, the same for every plane. */
  readonly ranges: readonly PageRange[];
  /**
   * Identifies the buffers: the same object for planes that share them, as previews of one load do.
   */
  readonly storage: object;
  readonly #memory: GpuMemory;
  readonly #name: string;
  readonly #chunks: Plane;
  readonly #motion: MotionPlanes | null;
  readonly #geometry = new Map<GeometryPrecision, Plane>();
  readonly #sh = new Map<ShPrecision, Plane>();
  /** `CloudPages` by their two precisions. */
  readonly #pages = new Map<string, CloudPages>();
  #held: HeldPrecisions | null = null;

  /** Takes ownership of planes on the GPU. */
  constructor(memory: GpuMemory, name: string, made: MadePlanes) {
    this.#memory = memory;
    this.#name = name;
    this.shDegree = made.shDegree;
    this.hasOwnPalette = made.hasOwnPalette ?? false;
    this.ranges = made.ranges;
    this.storage = made.geometry[0] ?? this;
    this.#chunks = made.chunks;
    this.#motion = made.motion ?? null;
    this.#geometry.set(made.geometryPrecision, made.geometry);
    if (this.shDegree === 0) for (const precision of SH_PRECISIONS) this.#sh.set(precision, []);
    else this.#sh.set(made.shPrecision, made.harmonics);
  }

  /**
   * Uploads `packed`.
   *
   * @throws GpuLimitError if a chunk of the largest plane cannot be bound, or the planes exceed the
   *   budget; nothing is left allocated then.
   */
  static upload(memory: GpuMemory, limits: DeviceLimits, packed: PackedCloud, name: string): CloudPlanes {
    const { degree: shDegree, precision: shPrecision } = packed.harmonics;
    const ranges = pagesOf(limits, packed.count, shDegree, name);
    const place = { memory, name, ranges };
    const made: Plane[] = [];
    const keep = (plane: Plane) => {
      made.push(plane);
      return plane;
    };
    try {
      return new CloudPlanes(memory, name, {
        shDegree,
        shPrecision,
        hasOwnPalette: shPrecision === 'palette',
        geometryPrecision: packed.geometry.precision,
        ranges,
        chunks: keep(uploadPlane(place, 'chunks', chunksOf(packed.chunks))),
        geometry: keep(uploadGeometry(place, packed.geometry)),
        harmonics: keep(uploadHarmonics(place, packed.harmonics)),
        motion: packed.motion && {
          splats: keep(uploadPlane(place, 'motion', motionWordsOf(packed.motion))),
          reaches: keep(uploadPlane(place, 'reaches of motion', reachesOf(packed.motion))),
        },
      });
    } catch (error) {
      for (const buffer of made.flat()) memory.destroy(buffer);
      throw error;
    }
  }

  /** Precisions of the planes; the same object until a plane is added or freed. */
  get held(): HeldPrecisions {
    this.#held ??= {
      geometry: GEOMETRY_PRECISIONS.filter((precision) => this.#geometry.has(precision)),
      sh: SH_PRECISIONS.filter((precision) => this.hasOwnPalette || this.#sh.has(precision)),
    };
    return this.#held;
  }

  get bytes(): number {
    return this.memory().totalBytes;
  }

  memory(): CloudMemory {
    const geometryBytes = bytesByPrecision(this.#geometry);
    const shBytes = bytesByPrecision(this.#sh);
    const chunksBytes = bytesOf(this.#chunks);
    const motionBytes = this.#motion ? bytesOf(this.#motion.splats) + bytesOf(this.#motion.reaches) : 0;
    const all = [chunksBytes, motionBytes, ...Object.values(geometryBytes), ...Object.values(shBytes)];
    const totalBytes = all.reduce((sum, bytes) => sum + bytes, 0);
    return { totalBytes, geometryBytes, shBytes, chunksBytes, ...(this.#motion && { motionBytes }) };
  }

  /**
   * Returns the planes to draw for `wanted`. Geometry and harmonics each get the wanted precision,
   * else the next finer one held, else the finest.
   */
  pagesFor(wanted: CloudPrecision): CloudPages {
    const { geometry, sh } = this.held;
    const geometryPrecision = nearestPrecision(geometry, wanted.geometryPrecision, GEOMETRY_PRECISIONS);
    const shPrecision = this.storedAs(nearestPrecision(sh, wanted.shPrecision, SH_PRECISIONS));
    const key = `${geometryPrecision} ${shPrecision}`;
    const pages = this.#pages.get(key) ?? this.#pagesOf({ geometryPrecision, shPrecision });
    this.#pages.set(key, pages);
    return pages;
  }

  /** Bounds of the chunks. */
  get chunksPlane(): Plane {
    return this.#chunks;
  }

  geometryPlane(precision: GeometryPrecision): Plane | undefined {
    return this.#geometry.get(precision);
  }

  shPlane(precision: ShPrecision): Plane | undefined {
    return this.#sh.get(this.storedAs(precision));
  }

  /**
   * The precision in which harmonics of precision `held` are stored: `palette` if the source has
   * one.
   */
  storedAs(held: ShPrecision): ShPrecision {
    return this.hasOwnPalette ? 'palette' : held;
  }

  /** Makes `plane` part of the cloud, or frees it if the cloud already holds its precision. */
  adoptGeometry(precision: GeometryPrecision, plane: Plane): void {
    this.#adopt(this.#geometry, precision, plane);
  }

  adoptSh(precision: ShPrecision, plane: Plane): void {
    this.#adopt(this.#sh, precision, plane);
  }

  /** Frees all planes that no claim needs. */
  keepOnly(claims: readonly CloudPrecision[]): void {
    for (const [precision, plane] of this.#geometry) {
      if (claims.some(({ geometryPrecision }) => geometryPrecision === precision)) continue;
      this.#drop(this.#geometry, precision, plane);
    }
    for (const [precision, plane] of this.#sh) {
      if (this.shDegree === 0 || this.hasOwnPalette) continue;
      if (claims.some(({ shPrecision }) => shPrecision === precision)) continue;
      this.#drop(this.#sh, precision, plane);
    }
    for (const [key, pages] of this.#pages) if (!isHeld(this.held, pages)) this.#pages.delete(key);
  }

  free(plane: Plane): void {
    for (const buffer of plane) this.#memory.destroy(buffer);
  }

  /** @param others planes that belong to another cloud now, and stay. */
  destroy(others: readonly Plane[] = []): void {
    const { splats = [], reaches = [] } = this.#motion ?? {};
    for (const plane of [this.#chunks, splats, reaches, ...this.#geometry.values(), ...this.#sh.values()])
      if (!others.includes(plane)) this.free(plane);
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
      motion: this.#motion && { splats: this.#motion.splats[page], reaches: this.#motion.reaches[page] },
    }));
    return { ...precision, pages };
  }

  /** The memory, name and pages for further planes of the cloud. */
  get place(): PlanePlace {
    return { memory: this.#memory, name: this.#name, ranges: this.ranges };
  }
}

/** The memory, name and pages of a cloud; each plane has a buffer per page. */
export interface PlanePlace {
  readonly memory: GpuMemory;
  readonly name: string;
  readonly ranges: readonly PageRange[];
}

/** Uploads geometry as a plane that no cloud owns yet. */
export function uploadGeometry(place: PlanePlace, { precision, words }: PackedGeometry): Plane {
  return uploadPlane(place, 'geometry', wordsOf(words, GEOMETRY_WORDS[precision]));
}

/**
 * Uploads harmonics as a plane that no cloud owns yet; empty at degree 0. Each page of a palette
 * has all entries.
 */
export function uploadHarmonics(place: PlanePlace, harmonics: StoredHarmonics): Plane {
  if (harmonics.degree === 0) return [];
  const page =
    harmonics.precision === 'palette'
      ? paletteWordsOf(harmonics)
      : wordsOf(harmonics.words, harmonics.wordsPerSplat);
  return uploadPlane(place, 'spherical harmonics', page);
}

const bitsOf = ({ buffer }: Float32Array<ArrayBuffer>) => new Uint32Array(buffer);

function motionWordsOf({ words }: PackedMotion): WordsOfPage {
  return wordsOf(bitsOf(words), SHADER_CONSTANTS.MOTION_WORDS);
}

function reachesOf({ reaches }: PackedMotion): WordsOfPage {
  return wordsOfChunks(bitsOf(reaches), SHADER_CONSTANTS.TIME_INTERVALS * SHADER_CONSTANTS.REACH_WORDS);
}

/** Returns the words of the page that holds splats `start` to `end`. */
type WordsOfPage = (start: number, end: number) => Uint32Array;

export function wordsOf(words: Uint32Array, wordsPerSplat: number): WordsOfPage {
  return (start, end) => words.subarray(start * wordsPerSplat, end * wordsPerSplat);
}

function wordsOfChunks(words: Uint32Array, perChunk: number): WordsOfPage {
  return (start, end) => words.subarray((start / CHUNK_SPLATS) * perChunk, chunkCountOf(end) * perChunk);
}

/** Chunks of a page, from the `Chunk` structs of all. */
export function chunksOf(chunks: ArrayBuffer): WordsOfPage {
  return wordsOfChunks(new Uint32Array(chunks), CHUNK_WORDS.count);
}

export function uploadPlane(place: PlanePlace, what: string, wordsOfPage: WordsOfPage): Plane {
  return planeOf(place, ({ start, end }, page) =>
    place.memory.createFilledBuffer(`${place.name} ${what} ${page}`, wordsOfPage(start, end)),
  );
}

/** Makes a buffer per page. If one fails, the others are freed. */
export function planeOf(
  { memory, ranges }: PlanePlace,
  make: (range: PageRange, page: number) => GPUBuffer,
): Plane {
  const made: GPUBuffer[] = [];
  try {
    for (const [page, range] of ranges.entries()) made.push(make(range, page));
    return made;
  } catch (error) {
    for (const buffer of made) memory.destroy(buffer);
    throw error;
  }
}

/**
 * Pages of a cloud of `count` splats.
 *
 * @throws GpuLimitError if a chunk of the largest plane cannot be bound.
 */
export function pagesOf(limits: DeviceLimits, count: number, degree: ShDegree, name: string): PageRange[] {
  return pageRanges(count, pageSplats(limits, degree, name));
}

function bytesByPrecision<Precision extends string>(planes: ReadonlyMap<Precision, Plane>) {
  // At degree 0, every precision of the harmonics has a plane without buffers.
  const held = [...planes].filter(([, plane]) => plane.length > 0);
  return Object.fromEntries(held.map(([precision, plane]) => [precision, bytesOf(plane)])) as Partial<
    Record<Precision, number>
  >;
}

function bytesOf(plane: Plane): number {
  return plane.reduce((sum, { size }) => sum + size, 0);
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
