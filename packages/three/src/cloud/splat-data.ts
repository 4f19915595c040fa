import {
  type CloudLease,
  type CloudPrecision,
  type LastingSource,
  lastingSource,
  mostExact,
  type PackedCloud,
  type SourceOptions,
  type SplatCloud,
  type SplatEngine,
  type SplatSet,
  type TimeRange,
} from '@websplatter/core';
import type { SplatSelection } from '@websplatter/core/effects';
import { Box3, type Intersection, type Raycaster, type Sphere, Vector3 } from 'three/webgpu';
import { type LossListener, tellOfLoss } from '../renderer/tell-of-loss.ts';
import type { CastRay, RayTarget } from './cast-ray.ts';
import type { DataEdits, Place } from './data-edits.ts';
import { tellOfRays } from './tell-of-rays.ts';

/** The splats on one engine. */
interface Upload extends LossListener {
  /** A promise while the splats are read again. */
  cloud: SplatCloud | Promise<SplatCloud>;
  /** Aborts the reading. */
  readonly abort: AbortController;
  /** Precision that each user needs; null for users without a need of their own. */
  readonly users: Map<object, CloudPrecision | null>;
  /** Claims the users' precision; null before any of them needs another one than was uploaded. */
  lease: CloudLease | null;
  /** The last claim, the engine's accuracy then, and its outcome; null: nothing is claimed. */
  claimed: (CloudPrecision & { readonly engineAccuracy: object; readonly met: Promise<void> }) | null;
}

/** How splats are loaded again. */
export interface DataOptions extends SourceOptions {
  /** See `SplatLoader.budgetBytes`. */
  readonly budgetBytes?: number;
}

/** A cloud on the engine that has loaded it. */
export interface LoadedCloud {
  readonly engine: SplatEngine;
  readonly cloud: SplatCloud;
  /** Precision that the cloud was loaded in. */
  readonly precision: CloudPrecision;
}

/** Splats that each engine makes anew. */
export interface MadeSplats extends Pick<PackedCloud, 'count' | 'bounds' | 'robustBounds'> {
  /** @param signal aborts when the cloud is no longer needed. */
  readonly make: (engine: SplatEngine, signal: AbortSignal) => Promise<SplatCloud>;
}

/**
 * Splats for any number of engines: uploaded to each engine that draws them, and freed there after
 * the last user. Splats of a URL, File or Blob leave memory after their first upload; another
 * engine, such as the one after a lost device, reads them again. Splats of other sources stay in
 * memory. A streamed scene has its own parts on each engine, by the views there.
 *
 * @example
 * const data = await new SplatLoader().loadAsync('/garden.ply');
 * scene.add(new SplatCloudObject(data), new SplatCloudObject(data));
 */
export class SplatData {
  /** Name for messages and labels. */
  readonly name: string;
  readonly count: number;
  /** Whether these are the splats of a partly read file: see `SplatLoader.onPreview`. */
  readonly isPreview: boolean;
  /** Bounds of the centres, in the cloud's own space. */
  readonly bounds: Box3;
  /** Bounds without the outermost splats, which enclose the scene itself. */
  readonly robustBounds: Box3;
  /** First and last time of a moving scene, in the unit of its file; null if it stands still. */
  readonly timeRange: TimeRange | null;
  /** Whether the last upload stays until `dispose`: a cache may hand splats to another user. */
  isCached = false;
  /** @internal Splats before packing, to pack them in other precisions; null if not in memory. */
  set: SplatSet | null = null;
  /** @internal Called when users come and go. */
  onUse: (() => void) | null = null;
  /** @internal Edits that the clouds on all engines follow. */
  edits: DataEdits | null = null;
  /** Source to read the splats from again; null: they stay in memory. */
  readonly #source: LastingSource | null;
  readonly #sourceOptions: DataOptions;
  /** Precision of new uploads; null: that of the engine. */
  readonly #precision: CloudPrecision | null;
  readonly #make: MadeSplats['make'] | null;
  readonly #uploads = new Map<SplatEngine, Upload>();
  #packed: PackedCloud | null;
  #castRay: CastRay | null = null;
  #preparing: Promise<void> | null = null;
  /** Time that rays are prepared for. */
  #raysTime: number | null = null;

  /**
   * @param splats packed splats; a cloud on an engine, freed after its last user, or by `dispose` if it
   *   has no user; or what makes their clouds.
   * @param source source to read the same splats from again; kept by reference. Without a source,
   *   they are drawn no more exactly than they were packed.
   * @param sourceOptions options of reading the source again.
   */
  constructor(
    splats: PackedCloud | LoadedCloud | MadeSplats,
    name = 'splats',
    source: LastingSource | URL | null = null,
    sourceOptions: DataOptions = {},
  ) {
    const isLoaded = 'engine' in splats;
    const { count, bounds, robustBounds } = isLoaded ? splats.cloud : splats;
    const packed = isLoaded || 'make' in splats ? null : splats;
    this.name = name;
    this.count = count;
    this.isPreview = isLoaded && splats.cloud.isPreview;
    this.bounds = boxOf(bounds);
    this.robustBounds = boxOf(robustBounds);
    this.timeRange = isLoaded ? splats.cloud.timeRange : (packed?.motion?.range ?? null);
    this.#source = source && lastingSource(source);
    this.#sourceOptions = sourceOptions;
    this.#packed = packed;
    this.#make = 'make' in splats ? splats.make : null;
    this.#precision = isLoaded
      ? splats.precision
      : packed && { geometryPrecision: packed.geometry.precision, shPrecision: packed.harmonics.precision };
    if (isLoaded) this.#place(splats.engine, () => splats.cloud).users.set(this, null);
  }

  /**
   * Returns a new selection of the splats with centres in a volume of the cloud's own space. Tests each
   * splat.
   *
   * @throws DestroyedError if the engine that holds them ends; SplatSourceError for a preview; the
   *   errors of reading, if they have to be read again.
   */
  async rowsIn(volume: Box3 | Sphere): Promise<SplatSelection> {
    const { rowsIn } = await import('./rows-in.ts');
    const user = {};
    try {
      return await rowsIn(volume, user, this, this.#packed ?? this.#source, this.#sourceOptions);
    } finally {
      this.release(user);
    }
  }

  /**
   * Makes the tree that rays are tested against, in a worker. It takes 24 bytes for each splat, 12 MB
   * at most, and supports up to 16 million splats. The first ray starts it, too; rays miss the splats
   * until it is done. Does nothing for a preview.
   *
   * @param time of a moving scene, in the unit of its file; null, the default: its first. Rays at
   *   objects that show another time request a tree of their own, and meet this one until that is done.
   * @throws DestroyedError if the engine that holds the splats ends or frees them; GpuLimitError if
   *   memory is lacking. A later call tries again.
   */
  prepareRays(time: number | null = null): Promise<void> {
    if (!this.#preparing || time !== this.#raysTime) {
      this.#raysTime = time;
      const preparing = this.#makeRays(time).catch((error: Error) => {
        if (this.#preparing === preparing) this.#preparing = null;
        throw error;
      });
      this.#preparing = preparing;
    }
    return this.#preparing;
  }

  /** @internal The splats have been edited: the next call of `prepareRays` begins anew. */
  renewRays(): void {
    this.#preparing = null;
  }

  /** @internal Adds the hit of a ray with these splats, as `object` shows them. */
  raycast(object: RayTarget, raycaster: Raycaster, intersects: Intersection[]): void {
    if (this.#castRay) this.#castRay(object, raycaster, intersects);
    else if (!this.#preparing)
      this.prepareRays(object.time).catch((error: Error) => tellOfRays(object, error));
  }

  async #makeRays(time: number | null): Promise<void> {
    if (this.isPreview) return;
    // Read now: the splats may leave memory during the import.
    const packed = this.#packed;
    const { rayCaster } = await import('./cast-ray.ts');
    const castRay = await rayCaster(this, packed, time);
    // A later call may ask for another time.
    if (time === this.#raysTime) this.#castRay = castRay;
  }

  /** @internal Splats in memory, without edits; null if they are on engines alone. */
  get packed(): PackedCloud | null {
    return this.#packed;
  }

  /** @internal The splats' clouds on all engines. */
  get places(): Iterable<Place> {
    return this.#uploads.values();
  }

  /**
   * Returns the cloud on `engine`; uploads it if its splats are in memory. Otherwise reads them again,
   * and returns the same promise until that is done. A preview exists only on the engine that loads
   * it; on others its promise stays pending. `user` keeps the cloud until `release`.
   *
   * @throws GpuLimitError, DestroyedError. The promise rejects with the errors of `engine.load`;
   *   with a SplatSourceError if the source has other splats now; and with an AbortError if its
   *   last user releases it first.
   */
  acquire(engine: SplatEngine, user: object): SplatCloud | Promise<SplatCloud> {
    const { cloud, users } = this.#uploads.get(engine) ?? this.#upload(engine);
    if (!users.has(user)) {
      users.set(user, null);
      users.delete(this);
      this.#freeUnused();
    }
    return cloud;
  }

  /** Releases the clouds that `user` acquired; an engine's last release frees GPU memory there. */
  release(user: object): void {
    for (const upload of this.#uploads.values()) if (upload.users.delete(user)) releaseUnneeded(upload);
    this.#freeUnused();
  }

  /** Frees GPU memory that waits for a first user. The splats can still be used. */
  dispose(): void {
    this.isCached = false;
    this.release(this);
  }

  /**
   * @internal Makes the cloud that `user` has acquired hold the finest precision that any of its users
   *   needs. Returns the same promise until another precision is needed, so it may be called in each
   *   frame. Null: `user` has no need of its own; other users may then change the precision.
   *
   * @returns the `met` of a lease; null without a need.
   */
  hold(engine: SplatEngine, user: object, precision: CloudPrecision | null): Promise<void> | null {
    const upload = this.#uploads.get(engine)!;
    const { users } = upload;
    if (precision === null) {
      if (users.get(user)) upload.claimed = null;
      users.set(user, null);
      releaseUnneeded(upload);
      return null;
    }
    users.set(user, precision);
    const needed = [...users.values()].filter((each) => each !== null);
    const { geometryPrecision, shPrecision } = mostExact(needed);
    const { claimed } = upload;
    const isClaimed =
      claimed?.geometryPrecision === geometryPrecision &&
      claimed.shPrecision === shPrecision &&
      // `setAccuracy` makes the clouds' own leases claim again, so this must release them again.
      claimed.engineAccuracy === engine.accuracy;
    if (isClaimed) return claimed.met;
    const met = claim(upload, { geometryPrecision, shPrecision });
    upload.claimed = { geometryPrecision, shPrecision, engineAccuracy: engine.accuracy, met };
    return met;
  }

  #upload(engine: SplatEngine): Upload {
    const { name } = this;
    const packed = this.#packed;
    const upload = this.#place(engine, (signal) => {
      if (!packed) return this.#make?.(engine, signal) ?? this.#readAgain(engine, signal);
      const sourceOptions = this.#sourceOptions;
      const source = this.#source ?? this.set ?? packed;
      const cloud = engine.addPacked(packed, { name, source, sourceOptions });
      // Apply edits before the cloud's first frame.
      void this.edits?.follow(cloud, packed);
      return cloud;
    });
    if (this.#source !== null) this.#packed = null;
    return upload;
  }

  async #readAgain(engine: SplatEngine, signal: AbortSignal): Promise<SplatCloud> {
    const { readAgain } = await import('./read-again.ts');
    const options = { ...this.#sourceOptions, precision: this.#precision!, signal };
    return readAgain(this, this.#source, engine, options);
  }

  #place(engine: SplatEngine, bring: (signal: AbortSignal) => Upload['cloud']): Upload {
    const abort = new AbortController();
    const precision = this.#precision;
    const claimed = precision && {
      ...precision,
      engineAccuracy: engine.accuracy,
      met: Promise.resolve(),
    };
    const forget = () => abort.signal.aborted || this.#uploads.delete(engine);
    const upload: Upload = {
      cloud: bring(abort.signal),
      abort,
      onLost: forget,
      users: new Map(),
      lease: null,
      claimed,
    };
    this.#uploads.set(engine, upload);
    tellOfLoss(engine, upload);
    Promise.resolve(upload.cloud)
      .then((cloud) => {
        upload.cloud = cloud;
        return cloud.uploaded;
      })
      .catch(forget);
    return upload;
  }

  #freeUnused(): void {
    for (const [engine, { cloud, abort, users }] of this.#uploads) {
      const isKept = this.isCached && this.#uploads.size === 1;
      if (users.size > 0 || isKept) continue;
      this.#uploads.delete(engine);
      abort.abort();
      if (!(cloud instanceof Promise)) cloud.destroy();
    }
    this.onUse?.();
  }
}

/** Claims `precision`; then releases the cloud's own lease, so that the users alone decide. */
async function claim(upload: Upload, precision: CloudPrecision): Promise<void> {
  const { lease } = upload;
  const cloud = upload.cloud as SplatCloud;
  // A preview's planes are still being made.
  if (cloud.isPreview) return;
  if (lease) lease.change(precision);
  else upload.lease = cloud.hold(precision);
  await upload.lease!.met;
  cloud.ownLease.release();
}

/** Releases the lease if no user has a need of its own. */
function releaseUnneeded(upload: Upload): void {
  const isNeeded = [...upload.users.values()].some((precision) => precision !== null);
  if (isNeeded || !upload.lease) return;
  upload.lease.release();
  upload.claimed = null;
}

function boxOf({ min, max }: PackedCloud['bounds']): Box3 {
  return new Box3(new Vector3(...min), new Vector3(...max));
}
