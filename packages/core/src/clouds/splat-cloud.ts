import { DestroyedError, SplatSourceError } from '../data/errors.ts';
import { given } from '../data/given.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { CloudFacts } from '../data/packing/cloud-facts.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { Bounds, PackedCloud } from '../data/packing/packed-cloud.ts';
import type { CloudPrecision, GeometryPrecision } from '../data/packing/precision.ts';
import type { SplatEdits } from '../data/splats/splat-edits.ts';
import type { DropCounts, ShDegree, SplatSet } from '../data/splats/splat-set.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { LastingSource, SourceOptions } from '../io/sources/splat-source.ts';
import { type CloudLease, CloudLeases, type HoldOptions, type MakeOptions } from './cloud-leases.ts';
import { type CloudPages, CloudPlanes, type HeldPrecisions, type Plane } from './cloud-planes.ts';
import type { CloudStream } from './cloud-stream.ts';
import type { CloudFit } from './fit-settings.ts';
import type { Levels } from './levels.ts';
import type { TouchedSplats } from './touched-links.ts';

/** A source to read a cloud's splats from again, any number of times, in other precisions. */
export type CloudSource = LastingSource | URL | SplatSet<Harmonics> | PackedCloud;

export interface SplatCloudOptions {
  /** For messages and labels. */
  readonly name: string;
  /** Tried in this order; kept by reference as long as the cloud lives. */
  readonly source?: CloudSource | readonly CloudSource[] | null;
  /** How files among the sources are read. */
  readonly sourceOptions?: SourceOptions;
  /**
   * Adds the planes of a precision to those that `cloud` holds; if it rejects, it adds none.
   * Without it the cloud holds only the uploaded planes.
   */
  readonly makePlanes?: (cloud: SplatCloud, precision: CloudPrecision, options: MakeOptions) => Promise<void>;
  /**
   * Makes the levels of detail of `cloud`, unless `check`, called now and then, throws. Without it
   * there are none.
   */
  readonly makeLevels?: (cloud: SplatCloud, check: () => void) => Promise<Levels>;
  /** Where the cloud shows what is there of a scene of any size; default null. */
  readonly pool?: CloudPool | null;
  /** Whether the planes belong to a load in progress, which the cloud previews. Default false. */
  readonly isPreview?: boolean;
  /**
   * Most visible splats, first in storage order, that a frame of the cloud alone draws; default
   * all.
   */
  readonly visibleLimit?: number;
  /** Rejects if memory was lacking for the planes; null if they are there. */
  readonly checked?: Promise<void> | null;
  /** See `SplatCloud.fit`. */
  readonly fit?: CloudFit | null;
  /** See `SplatCloud.compileStretched`. Default: no view shows the cloud. */
  readonly compileStretched?: (cloud: SplatCloud) => Promise<void> | null;
  /** Called when bytes of the cloud's planes have been written anew. */
  readonly onWritten?: (bytes: number) => void;
  /** Called when the cloud has been destroyed. */
  readonly onDestroyed?: (cloud: SplatCloud) => void;
}

/** Room for parts of a scene that take turns. */
export interface CloudPool {
  /** Most splats and blobs that a frame draws of what is there. */
  readonly capacity: number;
  /** One `Chunk` struct per chunk, as of now; a buffer that has been read never changes. */
  readonly chunks: ArrayBuffer;
}

/** Facts about a cloud's splats, besides its planes. */
export interface CloudContents
  extends Pick<
    PackedCloud,
    'count' | 'origin' | 'bounds' | 'robustBounds' | 'dropped' | 'fileIndices' | 'facts' | 'chunks'
  > {
  /** Precision of the planes. */
  readonly precision: CloudPrecision;
}

/** The hooks that keep a cloud as edits or a morph have it. */
export interface CloudEditing {
  /** Null where a morph changes the cloud. */
  readonly edits: SplatEdits | null;
  /** The cloud as it was uploaded. */
  readonly unedited: { readonly chunks: ArrayBuffer };
  readonly touched: Readonly<TouchedSplats>;
  /** Call before levels are made: they will show the splats as these are edited now. */
  readonly beginLevels: () => void;
  /** Writes changes since the last call. Call before frames are planned and planes read. */
  readonly flush: () => void;
  /** Reads unedited geometry of `plane`; call the result once the cloud has that, to edit it. */
  readonly rebase: (precision: GeometryPrecision, plane: Plane) => Promise<() => void>;
  readonly end: () => void;
}

/** Advice where a cloud finds no memory. */
export const MEMORY_ADVICE = 'Load fewer splats, or with a coarser accuracy.';

/** Splats on the GPU. */
export class SplatCloud {
  /** For messages and labels. */
  readonly name: string;
  readonly count: number;
  /** Degree of the stored harmonics, without invisible bands. `facts` has the file's degree. */
  readonly shDegree: ShDegree;
  /** Facts about the splats, found when they were packed; edits may change some. */
  facts: CloudFacts;
  /** Scene-space point, in float64, that stored positions are relative to. */
  readonly origin: Vec3;
  /** Bounds of the centres, scene space, as of the last frame. */
  bounds: Bounds;
  /** Bounds without the outermost splats, scene space: the part that a camera should show. */
  robustBounds: Bounds;
  /** Numbers of dropped rows of the file, by reason. */
  readonly dropped: DropCounts;
  /** Row in the file of each stored splat. */
  fileIndices: Uint32Array;
  /** @internal Empty if the sources are gone: see `hold`. */
  readonly sources: readonly CloudSource[];
  /** @internal */
  readonly sourceOptions: SourceOptions;
  /** @internal */
  planes: CloudPlanes;
  /** @internal */
  readonly leases: CloudLeases;
  /** Device that holds the cloud. */
  readonly device: GPUDevice;
  /** Whether this is a part of a cloud that is loading: see `LoadOptions`. */
  readonly isPreview: boolean;
  /** @internal See `SplatCloudOptions`. */
  readonly visibleLimit: number;
  /** Coarser settings taken by the load for lack of memory (`LoadOptions.fit`); null if none. */
  readonly fit: CloudFit | null;
  /**
   * @internal Settles when the cloud's planes have changed, or the next preview has taken its place;
   *   views keep their last image until then. Null: the cloud can be drawn.
   */
  heldUntil: Promise<void> | null = null;
  /** @internal What edits or morphs the cloud; null: nothing does. */
  editing: CloudEditing | null = null;
  /** @internal Blobs to draw instead of splats that are too small to tell apart; null: none. */
  levels: Levels | null = null;
  /** @internal Null where all splats are on the GPU. */
  pool: CloudPool | null;
  /** Brings the parts of its scene that views need to the GPU; null where all is there. */
  stream: CloudStream | null = null;
  /** @internal Grows whenever edits, a morph or a pool change what frames show. */
  version = 0;
  /**
   * @internal Compiles the shaders that draw the cloud once its splats are not round any more, in
   *   every view that shows it; null: no view does.
   */
  readonly compileStretched: () => Promise<void> | null;
  /** @internal */
  readonly onWritten: (bytes: number) => void;
  /**
   * Resolves when the device has had memory for the cloud; views draw it from then on. Rejects with
   * a GpuLimitError if it has not, and then the cloud has been destroyed.
   */
  readonly uploaded: Promise<void>;
  readonly #makeLevels: SplatCloudOptions['makeLevels'];
  #chunks: ArrayBuffer;
  #levelsMade: Promise<void> | null = null;
  #levelsLack: Error | null = null;
  readonly #onDestroyed: (cloud: SplatCloud) => void;
  #isUploaded = false;
  #lack: Error | null = null;
  #endedBecause: string | null = null;

  /** Takes over `planes`, which hold what `contents` describes. */
  constructor(device: GPUDevice, planes: CloudPlanes, contents: CloudContents, options: SplatCloudOptions) {
    const { name, source = null, makePlanes, isPreview = false, onDestroyed = () => {} } = options;
    const { visibleLimit = Number.POSITIVE_INFINITY, checked = null, compileStretched } = options;
    this.compileStretched = () => compileStretched?.(this) ?? null;
    this.onWritten = options.onWritten ?? (() => {});
    this.name = name;
    this.count = contents.count;
    this.shDegree = planes.shDegree;
    this.facts = contents.facts;
    this.origin = contents.origin;
    this.bounds = contents.bounds;
    this.robustBounds = contents.robustBounds;
    this.dropped = contents.dropped;
    this.fileIndices = contents.fileIndices;
    this.sources = [source ?? []].flat();
    this.sourceOptions = options.sourceOptions ?? {};
    this.#chunks = contents.chunks;
    this.isPreview = isPreview;
    this.pool = options.pool ?? null;
    this.visibleLimit = visibleLimit;
    this.fit = options.fit ?? null;
    this.#onDestroyed = onDestroyed;
    this.#makeLevels = options.makeLevels;
    this.device = device;
    this.planes = planes;
    this.leases = new CloudLeases(contents.precision, {
      name,
      // One that was loaded as rows is read again for it.
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
    this.#isUploaded = checked === null;
    this.uploaded = this.#awaitMemory(checked);
    this.uploaded.catch(() => {});
  }

  /** @internal Whether views keep their last image for now. */
  get isHeld(): boolean {
    return this.heldUntil !== null;
  }

  /** @internal Whether `uploaded` has resolved. */
  get isUploaded(): boolean {
    return this.#isUploaded;
  }

  /** Why there was no memory for the cloud, which is destroyed then; else null. */
  get lack(): Error | null {
    return this.#lack;
  }

  async #awaitMemory(checked: Promise<void> | null): Promise<void> {
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
   * @throws GpuLimitError if it cannot be bound, or exceeds the engine's budget; nothing is left
   *   allocated then.
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

  /** Precisions in which the cloud can be drawn without making or reading anything first. */
  get precisions(): HeldPrecisions {
    return this.planes.held;
  }

  /** The cloud's own lease: see `hold`. */
  get ownLease(): CloudLease {
    return this.leases.own;
  }

  /**
   * Claims this precision until the lease is changed or released. The cloud holds the planes that
   * its leases claim, and frees all others. Its own lease claims the uploaded precision, until the
   * engine's accuracy, a target or `engine.requestPrecision` changes that; release `cloud.ownLease`
   * if your leases cover everything that shows the cloud.
   *
   * A coarser precision than the cloud holds is made on the GPU. For a finer one the splats are
   * read again in the background, from the address, File or Blob they were loaded from, or the
   * SplatSet they were added from. All planes of a claim become available at once, and the next
   * frame is drawn with them; until then, and if the claim fails, nothing changes.
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
   * Makes the levels of detail that frames with a `detail` of less than `full` draw, once: blobs
   * that stand for several splats, on the GPU, of the planes at hand. They take about 135 bytes per
   * splat of the cloud at degree 3, and 81 at degree 0. Views that are asked for such frames do this
   * by themselves, and draw the same clouds as their last frame did until it is done. Splats that are
   * edited later are drawn one by one; call this again once many are, and levels are made anew.
   *
   * @returns resolves when frames can use them. Rejects with a GpuLimitError if memory is lacking,
   *   a SplatSourceError for a preview, a DestroyedError if cloud, engine or device end first.
   *   It may be called again then.
   */
  async makeLevels(): Promise<void> {
    this.checkUsable();
    // They come with the parts of its scene.
    if (this.pool) return;
    if (this.levels && this.editing && this.editing.touched.count > 0) {
      this.levels.destroy();
      this.levels = null;
      this.#levelsMade = null;
    }
    this.#levelsMade ??= this.#madeLevels().catch((error) => {
      this.#levelsMade = null;
      this.#levelsLack = error;
      throw error;
    });
    await this.#levelsMade;
  }

  /** Why frames with less than full detail draw all splats nevertheless, if levels failed; else null. */
  get levelsLack(): Error | null {
    return this.#levelsLack;
  }

  async #madeLevels(): Promise<void> {
    if (!this.#makeLevels || this.isPreview)
      throw new SplatSourceError(this.name, 'it is still loading, so no levels of detail can be made yet.');
    await this.uploaded;
    // Nothing stands for no splats.
    if (this.count === 0) return;
    this.checkUsable();
    this.editing?.beginLevels();
    const levels = await this.#makeLevels(this, () => this.checkUsable());
    if (this.isDestroyed) levels.destroy();
    this.checkUsable();
    this.levels = levels;
    this.#levelsLack = null;
  }

  /** GPU memory of all planes of the cloud together; 0 for a preview, which has none of its own. */
  get bytes(): number {
    return this.isDestroyed || this.isPreview ? 0 : this.planes.bytes + (this.levels?.bytes ?? 0);
  }

  /** @internal One `Chunk` struct per chunk; never changes, but another may take its place. */
  get chunks(): ArrayBuffer {
    // Parts of a scene come and go more often than their chunks are read.
    return this.pool?.chunks ?? this.#chunks;
  }

  set chunks(chunks: ArrayBuffer) {
    this.#chunks = chunks;
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
   * Returns the planes to draw for `wanted`: for geometry and for harmonics, the same precision,
   * else the next finer one held, else the finest.
   */
  pagesFor(wanted: CloudPrecision): CloudPages {
    return this.planes.pagesFor(given(wanted, {}, 'wanted'));
  }

  /**
   * @internal Shows what is in another pool, which has taken the place of its own.
   *
   * @param checked as for a new cloud.
   */
  takePool(
    pool: CloudPool & Levels,
    { planes, fileIndices }: Pick<SplatCloud, 'planes' | 'fileIndices'>,
    checked: Promise<void> | null,
  ): void {
    this.pool = pool;
    this.levels = pool;
    this.planes = planes;
    this.fileIndices = fileIndices;
    this.version++;
    this.#awaitMemory(checked).catch(() => {});
  }

  /** Frees the GPU memory; frames already submitted are not affected. */
  destroy(): void {
    if (!this.end('it was destroyed')) return;
    if (!this.isPreview) this.planes.destroy();
    this.levels?.destroy();
  }

  /** @internal Ends the cloud without freeing its planes. Returns false if it has ended before. */
  end(because: string): boolean {
    if (this.isDestroyed) return false;
    this.#endedBecause = because;
    this.editing?.end();
    this.stream?.end();
    this.leases.end(new DestroyedError(`The cloud ${this.name}`, because));
    this.#onDestroyed(this);
    return true;
  }
}
