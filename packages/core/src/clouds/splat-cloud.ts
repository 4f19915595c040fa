import { DestroyedError, fetched, SplatSourceError } from '../data/errors.ts';
import { given } from '../data/given.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { CloudFacts } from '../data/packing/cloud-facts.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import { type Bounds, type PackedCloud, totalBounds } from '../data/packing/packed-cloud.ts';
import type { CloudPrecision } from '../data/packing/precision.ts';
import type { DropCounts, ShDegree, SplatSet } from '../data/splats/splat-set.ts';
import type { PackedMotion } from '../features/motion/pack-motion.data.ts';
import type { TimeRange } from '../features/motion/splat-motion.data.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { LastingSource, SourceOptions } from '../io/sources/splat-source.ts';
import { type CloudFeature, writerOf } from './cloud-feature.ts';
import { type CloudLease, CloudLeases, type HoldOptions, type MakeOptions } from './cloud-leases.ts';
import { type CloudPages, CloudPlanes, type HeldPrecisions } from './cloud-planes.ts';
import type { CloudFit } from './fit-settings.ts';
import type { Levels } from './levels/levels.ts';
import type { CloudStream } from './stream/cloud-stream.ts';

/** A source from which a cloud's splats can be read repeatedly, in other precisions. */
export type CloudSource = LastingSource | URL | SplatSet<Harmonics> | PackedCloud;

export interface SplatCloudOptions {
  /** For messages and labels. */
  readonly name: string;
  /** Tried in this order. Referenced as long as the cloud lives. */
  readonly source?: CloudSource | readonly CloudSource[] | null;
  /** How files among the sources are read. */
  readonly sourceOptions?: SourceOptions;
  /**
   * Adds the planes of a precision to `cloud`; if it rejects, it adds none. Default: the cloud
   * holds only the uploaded planes.
   */
  readonly makePlanes?: (cloud: SplatCloud, precision: CloudPrecision, options: MakeOptions) => Promise<void>;
  /**
   * Makes the levels of detail of `cloud`. Ends if `check`, which it calls repeatedly, throws.
   * Default: the cloud has none.
   */
  readonly makeLevels?: (cloud: SplatCloud, check: () => void) => Promise<Levels>;
  /** The pool of a streamed scene. Default: null, the cloud is wholly on the GPU. */
  readonly pool?: (CloudPool & Levels) | null;
  /** Fills the pool. */
  readonly stream?: CloudStream;
  /** Whether the cloud is a preview, whose planes belong to a running load. Default: false. */
  readonly isPreview?: boolean;
  /**
   * Most visible splats, first in storage order, that a frame of this cloud alone draws. Default:
   * all.
   */
  readonly visibleLimit?: number;
  /** Rejects if the device lacked memory for the planes; null if they are already allocated. */
  readonly checked?: Promise<void> | null;
  /** See `SplatCloud.fit`. */
  readonly fit?: CloudFit | null;
  /**
   * Compiles the shaders for anisotropic splats in every view that draws the cloud; returns null if no
   * view does, the default.
   */
  readonly compileStretched?: (cloud: SplatCloud) => Promise<void> | null;
  /** Called with the number of bytes whenever the cloud's planes are rewritten. */
  readonly onWritten?: (bytes: number) => void;
  /** Called when the cloud has been destroyed. */
  readonly onDestroyed?: (cloud: SplatCloud) => void;
}

/** GPU memory whose contents change as parts of a scene are streamed. */
export interface CloudPool {
  /** Most splats and blobs that one frame can draw from the pool. */
  readonly capacity: number;
  /** One `Chunk` struct per chunk, current; a returned buffer never changes. */
  readonly chunks: ArrayBuffer;
}

/** Properties of a cloud's splats besides its planes. */
export interface CloudContents
  extends Pick<
    PackedCloud,
    'count' | 'origin' | 'bounds' | 'robustBounds' | 'dropped' | 'fileIndices' | 'facts' | 'chunks' | 'motion'
  > {
  /** Precision of the planes. */
  readonly precision: CloudPrecision;
}

/** Advice in errors if the device lacks memory for a cloud. */
export const MEMORY_ADVICE = 'Load fewer splats, or with a coarser accuracy.';

/** Splats on the GPU. Its own methods alone change it: each says what has happened. */
export class SplatCloud {
  /** For messages and labels. */
  readonly name: string;
  readonly count: number;
  /** Degree of the stored harmonics, without invisible bands. `facts` has the file's degree. */
  readonly shDegree: ShDegree;
  /** Properties found when the splats were packed; edits may change some. */
  readonly facts: CloudFacts;
  /** Origin of stored positions, in scene space, float64. */
  readonly origin: Vec3;
  /** Bounds of the centres in scene space, as of the last frame. */
  readonly bounds: Bounds;
  /** Bounds in scene space without outliers: the part that a camera should show. */
  readonly robustBounds: Bounds;
  /** Numbers of dropped rows of the file, by reason. */
  readonly dropped: DropCounts;
  /** Row in the file per stored splat. */
  readonly fileIndices: Uint32Array;
  /**
   * First and last time of a moving cloud, in the unit of its file: trained scenes have 0 and 1. Null if
   * the splats stand still. `CloudInstance.time` chooses a time.
   */
  readonly timeRange: TimeRange | null;
  /** @internal What the cloud has besides its planes. Motion is there once `uploaded` resolves. */
  readonly features: readonly CloudFeature[] = [];
  /** @internal Chunks of the splats as they were uploaded, which features may have changed since. */
  readonly uploadedChunks: ArrayBuffer;
  /** @internal Empty if the sources are gone: see `hold`. */
  readonly sources: readonly CloudSource[];
  /** @internal */
  readonly sourceOptions: SourceOptions;
  /** @internal */
  readonly planes: CloudPlanes;
  /** @internal */
  readonly leases: CloudLeases;
  /** The device whose memory holds the cloud. */
  readonly device: GPUDevice;
  /** Whether this is a preview of a running load: see `LoadOptions`. */
  readonly isPreview: boolean;
  /** @internal See `SplatCloudOptions`. */
  readonly visibleLimit: number;
  /** Coarser settings that the load used for lack of memory (`LoadOptions.fit`); null if none. */
  readonly fit: CloudFit | null;
  /**
   * @internal Settles when the cloud's planes have changed, or the next preview has replaced this
   *   one. Until then views keep their last image. Null if the cloud can be drawn.
   */
  readonly heldUntil: Promise<void> | null = null;
  /**
   * @internal Blobs to draw in place of splats smaller than the allowed error; null if not made.
   */
  readonly levels: Levels | null;
  /** @internal Null if all splats are on the GPU. */
  readonly pool: CloudPool | null;
  /** @internal Incremented whenever features or a pool change the contents of frames. */
  readonly version: number = 0;
  /** Streams the parts of a scene that views need; null if the cloud is wholly on the GPU. */
  readonly stream: CloudStream | null;
  /**
   * Resolves once the device has confirmed memory for the cloud; views draw it from then on.
   * Rejects with a GpuLimitError if memory was lacking; the cloud has been destroyed then.
   */
  readonly uploaded: Promise<void>;
  readonly #calls: Pick<SplatCloudOptions, 'makeLevels' | 'compileStretched' | 'onWritten' | 'onDestroyed'>;
  #chunks: ArrayBuffer;
  #levelsMade: Promise<void> | null = null;
  #levelsLack: Error | null = null;
  #isUploaded = false;
  #lack: Error | null = null;
  #endedBecause: string | null = null;

  /** Takes ownership of `planes`, which hold the splats that `contents` describes. */
  constructor(device: GPUDevice, planes: CloudPlanes, contents: CloudContents, options: SplatCloudOptions) {
    const { name, source, sourceOptions = {}, makePlanes, checked = null, pool = null, ...others } = options;
    const { visibleLimit, isPreview = false, stream = null, fit = null, ...calls } = others;
    this.#calls = calls;
    this.name = name;
    this.count = contents.count;
    this.shDegree = planes.shDegree;
    this.facts = contents.facts;
    this.origin = contents.origin;
    this.bounds = contents.bounds;
    this.robustBounds = contents.robustBounds;
    this.dropped = contents.dropped;
    this.fileIndices = contents.fileIndices;
    this.timeRange = contents.motion?.range ?? null;
    this.sources = [source ?? []].flat();
    this.sourceOptions = sourceOptions;
    this.#chunks = contents.chunks;
    this.uploadedChunks = contents.chunks;
    this.isPreview = isPreview;
    this.pool = pool;
    this.levels = pool;
    this.stream = stream;
    this.visibleLimit = visibleLimit ?? Number.POSITIVE_INFINITY;
    this.fit = fit;
    this.device = device;
    this.planes = planes;
    this.leases = new CloudLeases(contents.precision, {
      name,
      // SOG files have a palette too, but rows loaded from them do not: a palette is read again.
      hasPalette: contents.facts.paletteEntries !== null || contents.facts.fileFacts?.format === 'sog',
      keepOnly: (claims) => {
        if (!isPreview && !this.pool) this.planes.keepOnly(claims);
      },
      make: async (precision, options) => {
        if (!makePlanes)
          throw new SplatSourceError(
            name,
            isPreview
              ? 'it is still loading, so no other planes can be made yet.'
              : this.pool
                ? 'only parts of it are there, in the precision of its file.'
                : 'no engine has uploaded it, so no other planes can be made.',
          );
        await this.uploaded;
        await makePlanes(this, precision, options);
      },
    });
    const moving = contents.motion ? this.#takeMotion(contents.motion) : null;
    this.#isUploaded = checked === null && moving === null;
    this.uploaded = this.#awaitMemory(moving ? Promise.all([checked, moving]) : checked);
    // Frames of a cloud that lacks memory throw `lack`, also if nobody awaits the upload.
    this.uploaded.catch(() => {});
  }

  /** @internal Whether views must keep their last image for now. */
  get isHeld(): boolean {
    return this.heldUntil !== null;
  }

  /** The one place that writes fields which are read-only to others. */
  #set(fields: Partial<SplatCloud>): void {
    Object.assign(this, fields);
  }

  /** @internal Has views keep their last image until `change` settles. */
  holdImage(change: Promise<unknown>): void {
    const release = () => this.#set({ heldUntil: null });
    this.#set({ heldUntil: change.then(release, release) });
  }

  /** @internal */
  addFeature(feature: CloudFeature): void {
    this.#set({ features: [...this.features, feature] });
  }

  /** @internal For a feature that could not begin. */
  removeFeature(feature: CloudFeature): void {
    this.#set({ features: this.features.filter((each) => each !== feature) });
  }

  /** @internal Call when a feature or the pool has changed the contents of frames. */
  markChanged(): void {
    this.#set({ version: this.version + 1 });
  }

  /** @internal Call when a feature has uploaded bytes for the cloud. */
  countWritten(bytes: number): void {
    this.#calls.onWritten?.(bytes);
  }

  /** @internal Replaces the chunks, and thereby the bounds, of splats that a feature has moved. */
  moveChunks(chunks: ArrayBuffer, robustBounds: Bounds): void {
    this.#chunks = chunks;
    this.#set({ bounds: totalBounds(chunks, this.origin), robustBounds });
  }

  /**
   * @internal Marks the splats as anisotropic: at once if no view draws the cloud, which returns null;
   *   else once the views have compiled the shaders for that.
   */
  stretch(): Promise<void> | null {
    const mark = () => {
      this.#set({ facts: { ...this.facts, isIsotropic: false } });
      this.markChanged();
    };
    const compiling = this.#calls.compileStretched?.(this);
    if (compiling) return compiling.then(mark);
    mark();
    return null;
  }

  /** @internal Whether `uploaded` has resolved. */
  get isUploaded(): boolean {
    return this.#isUploaded;
  }

  /** The error if memory was lacking, in which case the cloud is destroyed; else null. */
  get lack(): Error | null {
    return this.#lack;
  }

  /** Fetches the code of motions, which few scenes need. */
  async #takeMotion(packed: PackedMotion): Promise<void> {
    const { CloudMotion } = await fetched('motion', import('../features/motion/motion.clouds.ts'));
    this.addFeature(new CloudMotion(packed));
  }

  async #awaitMemory(checked: Promise<unknown> | null): Promise<void> {
    try {
      await checked;
      this.#isUploaded = true;
    } catch (error) {
      this.#lack = error as Error;
      this.destroy();
      throw error;
    }
  }

  /**
   * Uploads `packed`.
   *
   * @throws GpuLimitError if its planes cannot be bound, or exceed the engine's memory budget;
   *   nothing is left allocated then.
   */
  static upload(
    memory: GpuMemory,
    limits: GPUSupportedLimits,
    packed: PackedCloud,
    options: SplatCloudOptions,
  ): SplatCloud {
    const { geometry, harmonics } = packed;
    const precision = { geometryPrecision: geometry.precision, shPrecision: harmonics.precision };
    const { result: planes, checked } = memory.guard(options.name, MEMORY_ADVICE, () =>
      CloudPlanes.upload(memory, limits, packed, options.name),
    );
    const contents = { ...packed, precision };
    return new SplatCloud(memory.device, planes, contents, { ...options, checked });
  }

  /** Precisions in which the cloud can be drawn at once. */
  get precisions(): HeldPrecisions {
    return this.planes.held;
  }

  /** The cloud's own lease: see `hold`. */
  get ownLease(): CloudLease {
    return this.leases.own;
  }

  /**
   * Claims this precision until the lease is changed or released. The cloud holds the planes that
   * its leases claim, and frees all others. Its own lease claims the uploaded precision until the
   * engine's accuracy, a target or `engine.requestPrecision` changes it. Release `cloud.ownLease`
   * if your leases cover every use of the cloud.
   *
   * A coarser precision than the held one is made on the GPU. For a finer one the splats are read
   * again in the background: from their URL, File or Blob, or from the added SplatSet. All planes
   * of a claim become available at once, for the next frame. Until then, and if the claim fails,
   * nothing changes.
   *
   * @returns the lease, immediately. Its `met` resolves when the cloud holds the planes. It rejects
   *   with a SplatSourceError if the source is gone (streams, buffers), unreadable, too coarse, or
   *   now has other splats; SplatFileError; GpuLimitError if the planes do not fit into memory;
   *   InvalidArgumentError for an unknown precision; DestroyedError if cloud, engine or device end
   *   first; the signal's reason if it aborts; and an AbortError if the lease is changed or
   *   released first.
   */
  hold(precision: CloudPrecision, options?: HoldOptions): CloudLease {
    return this.leases.hold(precision, options);
  }

  /**
   * Makes the levels of detail for frames with a `detail` of less than `full`: blobs, each of which
   * merges several splats. They are made once, on the GPU, from the held planes. They take about
   * 135 bytes per splat of the cloud at degree 3, and 81 at degree 0.
   *
   * Views call this when a frame needs levels, and draw the clouds of their last frame until it is
   * done. Splats that are edited later are drawn one by one. Once many are, call this again to
   * rebuild the levels.
   *
   * @returns resolves when frames can use them. Rejects with a GpuLimitError if the device lacks
   *   memory, a SplatSourceError for a preview, a DestroyedError if cloud, engine or device end
   *   first. It may be called again then.
   */
  async makeLevels(): Promise<void> {
    this.checkUsable();
    // Levels of a streamed scene are part of its pool.
    if (this.pool) return;
    if (this.levels && writerOf(this)?.touched?.count) {
      this.levels.destroy();
      this.#set({ levels: null });
      this.#levelsMade = null;
    }
    this.#levelsMade ??= this.#madeLevels().catch((error) => {
      this.#levelsMade = null;
      this.#levelsLack = error;
      throw error;
    });
    await this.#levelsMade;
  }

  /**
   * Error of making levels, because of which frames draw all splats in spite of their `detail`;
   * else null.
   */
  get levelsLack(): Error | null {
    return this.#levelsLack;
  }

  async #madeLevels(): Promise<void> {
    const { makeLevels } = this.#calls;
    if (!makeLevels || this.isPreview)
      throw new SplatSourceError(this.name, 'it is still loading, so no levels of detail can be made yet.');
    await this.uploaded;
    // An empty cloud needs no levels.
    if (this.count === 0) return;
    this.checkUsable();
    for (const { lacksLevels } of this.features)
      if (lacksLevels) throw new SplatSourceError(this.name, lacksLevels);
    writerOf(this)?.beginLevels?.();
    const levels = await makeLevels(this, () => this.checkUsable());
    if (this.isDestroyed) levels.destroy();
    this.checkUsable();
    this.#set({ levels });
    this.#levelsLack = null;
  }

  /** Bytes of GPU memory of all planes and levels; 0 for a preview, which owns none. */
  get bytes(): number {
    return this.isDestroyed || this.isPreview ? 0 : this.planes.bytes + (this.levels?.bytes ?? 0);
  }

  /**
   * @internal One `Chunk` struct per chunk. The buffer never changes, but another may replace it.
   */
  get chunks(): ArrayBuffer {
    // Computed on demand, because parts of a scene change more often than chunks are read.
    return this.pool?.chunks ?? this.#chunks;
  }

  /** Whether the cloud, or its engine, was destroyed. */
  get isDestroyed(): boolean {
    return this.#endedBecause !== null;
  }

  /** @internal @throws DestroyedError if the cloud has ended, GpuLimitError if for lack of memory. */
  checkUsable(): void {
    if (this.#endedBecause === null) return;
    throw this.#lack ?? new DestroyedError(`The cloud ${this.name}`, this.#endedBecause);
  }

  /**
   * Returns the planes to draw for `wanted`. Geometry and harmonics each get the wanted precision,
   * else the next finer one held, else the finest.
   */
  pagesFor(wanted: CloudPrecision): CloudPages {
    return this.planes.pagesFor(given(wanted, {}, 'wanted'));
  }

  /**
   * @internal Replaces the pool by a resized one with the same contents.
   *
   * @param checked rejects if the device lacked memory for the planes, as for a new cloud.
   */
  takePool(
    pool: CloudPool & Levels,
    { planes, fileIndices }: Pick<SplatCloud, 'planes' | 'fileIndices'>,
    checked: Promise<void> | null,
  ): void {
    this.#set({ pool, levels: pool, planes, fileIndices });
    this.markChanged();
    // Frames throw `lack`.
    this.#awaitMemory(checked).catch(() => {});
  }

  /** Frees the GPU memory; frames already submitted are not affected. */
  destroy(): void {
    if (!this.end('it was destroyed')) return;
    if (!this.isPreview) this.planes.destroy();
    this.levels?.destroy();
  }

  /** @internal Ends the cloud without freeing its planes. Returns false if it had already ended. */
  end(because: string): boolean {
    if (this.isDestroyed) return false;
    this.#endedBecause = because;
    for (const feature of this.features) feature.end?.();
    this.stream?.end();
    this.leases.end(new DestroyedError(`The cloud ${this.name}`, because));
    this.#calls.onDestroyed?.(this);
    return true;
  }
}
