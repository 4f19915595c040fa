import { DestroyedError, SplatSourceError } from '../errors.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { CloudFacts } from '../packing/cloud-facts.ts';
import type { LogScaleRange } from '../packing/geometry.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import type { Bounds, PackedCloud } from '../packing/packed-cloud.ts';
import type { CloudPrecision } from '../packing/precision.ts';
import type { DropCounts, ShDegree, SplatSet } from '../splats/splat-set.ts';
import { type CloudLease, CloudLeases, type HoldOptions, type MakeOptions } from './cloud-leases.ts';
import { type CloudPages, CloudPlanes, type HeldPrecisions } from './cloud-planes.ts';

/** Where a cloud's splats can be had again, as often as need be, in other precisions than it holds. */
export type CloudSource = string | URL | Blob | SplatSet<Harmonics> | PackedCloud;

export interface SplatCloudOptions {
  /** For messages and labels. */
  readonly name: string;
  /** Tried in this order; kept by reference as long as the cloud lives. */
  readonly source?: CloudSource | readonly CloudSource[] | null;
  /**
   * Adds the planes of a precision to those that `cloud` holds; adds none where it rejects. Without it the cloud holds what
   * was uploaded.
   */
  readonly makePlanes?: (cloud: SplatCloud, precision: CloudPrecision, options: MakeOptions) => Promise<void>;
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
  /** @internal None where they are gone: see `hold`. */
  readonly sources: readonly CloudSource[];
  /** @internal Of all planes of the cloud, whichever were packed. */
  readonly logScaleRange: LogScaleRange;
  /** @internal One `Chunk` struct per chunk. */
  readonly chunks: ArrayBuffer;
  /** @internal */
  readonly planes: CloudPlanes;
  /** @internal */
  readonly leases: CloudLeases;
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
    { name, source = null, makePlanes, onDestroyed = () => {} }: SplatCloudOptions,
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
    const uploaded = {
      geometryPrecision: packed.geometry.precision,
      shPrecision: packed.harmonics.precision,
    };
    this.leases = new CloudLeases(uploaded, {
      name,
      keepOnly: (claims) => this.planes.keepOnly(claims),
      make: async (precision, options) => {
        if (!makePlanes)
          throw new SplatSourceError(name, 'no engine has uploaded it that could make other planes of it.');
        await makePlanes(this, precision, options);
      },
    });
  }

  /** In which precisions the cloud can be drawn without anything being made or read first. */
  get precisions(): HeldPrecisions {
    return this.planes.held;
  }

  /** The cloud's own lease: see `hold`. */
  get ownLease(): CloudLease {
    return this.leases.own;
  }

  /**
   * Claims this precision until the lease is changed or released. The cloud holds what its leases claim, and frees what none
   * of them claims. Its own lease claims what was uploaded, until the engine's accuracy, a wish or `engine.requestPrecision`
   * changes that; release `cloud.ownLease` where your leases speak for everything that shows the cloud.
   *
   * A coarser precision than the cloud holds is made on the GPU. For a finer one the splats are read again in the background,
   * from the address, File or Blob they were loaded from, or the SplatSet they were added from. All planes of a claim come at
   * once, and pictures change with the next frame that is drawn; until then, and where it fails, everything stays as it was.
   *
   * @returns at once. Its `met` resolves when the planes are held. It rejects with a SplatSourceError where the source is gone
   *   (streams, buffers), unreadable, too coarse, or has other splats now; SplatFileError; GpuLimitError where the planes do
   *   not fit into memory; InvalidArgumentError for an unknown precision; DestroyedError where cloud, engine or device end
   *   meanwhile; the signal's reason where it aborts, and an AbortError where the lease is changed or released before.
   */
  hold(precision: CloudPrecision, options?: HoldOptions): CloudLease {
    return this.leases.hold(precision, options);
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
    this.leases.end(new DestroyedError(`The cloud ${this.name}`, 'it was destroyed'));
    this.planes.destroy();
    this.#onDestroyed(this);
  }
}
