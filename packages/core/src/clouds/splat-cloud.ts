import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { CloudFacts } from '../packing/cloud-facts.ts';
import type { LogScaleRange } from '../packing/geometry.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import type { Bounds, PackedCloud } from '../packing/packed-cloud.ts';
import type { CloudPrecision } from '../packing/precision.ts';
import type { DropCounts, ShDegree, SplatSet } from '../splats/splat-set.ts';
import { type CloudPages, CloudPlanes, type HeldPrecisions } from './cloud-planes.ts';

/** Where a cloud's splats can be had again, as often as need be, in other precisions than it holds. */
export type CloudSource = string | URL | Blob | SplatSet<Harmonics> | PackedCloud;

export interface SplatCloudOptions {
  /** For messages and labels. */
  readonly name: string;
  /** Tried in this order; kept by reference as long as the cloud lives. */
  readonly source?: CloudSource | readonly CloudSource[] | null;
  /** Called when the cloud has been destroyed. */
  readonly onDestroyed?: (cloud: SplatCloud) => void;
}

/** Splats on the GPU. */
export class SplatCloud {
  /** For messages and labels. */
  readonly name: string;
  readonly count: number;
  /** Of what is stored: bands that cannot be seen are not. See `facts` for that of the file. */
  readonly shDegree: ShDegree;
  /** What was found in the splats when they were packed. */
  readonly facts: CloudFacts;
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
  /** @internal None where they are gone: see `SplatEngine.requestPrecision`. */
  readonly sources: readonly CloudSource[];
  /** @internal Of all planes of the cloud, whichever were packed. */
  readonly logScaleRange: LogScaleRange;
  /** @internal One `Chunk` struct per chunk. */
  readonly chunks: ArrayBuffer;
  /** @internal */
  readonly planes: CloudPlanes;
  /** @internal What it is held by. */
  readonly device: GPUDevice;
  readonly #onDestroyed: (cloud: SplatCloud) => void;
  #isDestroyed = false;

  /**
   * Uploads `packed`.
   *
   * @throws GpuLimitError, before anything is allocated, where it cannot be bound.
   */
  constructor(
    memory: GpuMemory,
    limits: GPUSupportedLimits,
    packed: PackedCloud,
    { name, source = null, onDestroyed = () => {} }: SplatCloudOptions,
  ) {
    this.name = name;
    this.count = packed.count;
    this.shDegree = packed.harmonics.degree;
    this.facts = packed.facts;
    this.origin = packed.origin;
    this.bounds = packed.bounds;
    this.robustBounds = packed.robustBounds;
    this.dropped = packed.dropped;
    this.fileIndices = packed.fileIndices;
    this.sources = [source ?? []].flat();
    this.logScaleRange = packed.geometry.logScaleRange;
    this.chunks = packed.chunks;
    this.#onDestroyed = onDestroyed;
    this.device = memory.device;
    this.planes = new CloudPlanes(memory, limits, packed, name);
  }

  /** In which precisions the cloud can be drawn without anything being made or read first. */
  get precisions(): HeldPrecisions {
    return this.planes.held;
  }

  /** What the cloud takes on the GPU, all of its planes together. */
  get bytes(): number {
    return this.#isDestroyed ? 0 : this.planes.bytes;
  }

  get isDestroyed(): boolean {
    return this.#isDestroyed;
  }

  /**
   * What is drawn of the cloud where this is asked for: of geometry and of spherical harmonics each the same precision,
   * else the next finer one held, else the finest.
   */
  pagesFor(wanted: CloudPrecision): CloudPages {
    return this.planes.pagesFor(wanted);
  }

  /** Frees the GPU memory; pictures already submitted are not affected. */
  destroy(): void {
    if (this.#isDestroyed) return;
    this.#isDestroyed = true;
    this.planes.destroy();
    this.#onDestroyed(this);
  }
}
