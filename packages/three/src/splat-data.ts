import {
  type CloudLease,
  type CloudPrecision,
  type CloudSource,
  GEOMETRY_WORDS,
  mostExact,
  type PackedCloud,
  type SplatCloud,
  type SplatEngine,
} from '@websplatter/core';
import { Box3, type Sphere, Vector3 } from 'three/webgpu';

interface Upload {
  readonly cloud: SplatCloud;
  /** Precision that each user needs; null for users without a need of their own. */
  readonly users: Map<object, CloudPrecision | null>;
  /** Claims the precision that the users need; null before any of them needs another one than was uploaded. */
  lease: CloudLease | null;
  /** The last claim, the engine's accuracy at that time, and its outcome; null: nothing is claimed. */
  claimed: (CloudPrecision & { readonly engineAccuracy: object; readonly met: Promise<void> }) | null;
}

/**
 * Splats in memory, and on the GPU of each engine that draws them: uploaded for the first user, freed after the last. The
 * copy in memory stays, so that another renderer, or a new one after a lost device, needs no second download.
 */
export class SplatData {
  /** Name for messages and labels. */
  readonly name: string;
  readonly packed: PackedCloud;
  /** Bounds of the centres, in the cloud's own space. */
  readonly bounds: Box3;
  /** Bounds without the outermost splats, which enclose the scene itself. */
  readonly robustBounds: Box3;
  readonly #source: CloudSource | null;
  readonly #uploads = new Map<SplatEngine, Upload>();

  /**
   * @param source from which the same splats can be read again for a finer precision than that of `packed`; kept by
   *   reference. Without a source, they are drawn no more exactly than they were packed.
   */
  constructor(packed: PackedCloud, name = 'splats', source: CloudSource | null = null) {
    this.packed = packed;
    this.name = name;
    this.bounds = boxOf(packed.bounds);
    this.robustBounds = boxOf(packed.robustBounds);
    this.#source = source;
  }

  get count(): number {
    return this.packed.count;
  }

  /** Returns the rows of splats with centres in a volume of the cloud's own space, for a SplatSelection. Tests each splat. */
  rowsIn(volume: Box3 | Sphere): number[] {
    const { geometry, origin, fileIndices } = this.packed;
    // A splat of any precision begins with its position in float32.
    const values = new Float32Array(geometry.words.buffer, geometry.words.byteOffset, geometry.words.length);
    const stride = GEOMETRY_WORDS[geometry.precision];
    const middle = new Vector3(...origin);
    const center = new Vector3();
    const isInside = (_row: number, i: number) =>
      volume.containsPoint(center.fromArray(values, stride * i).add(middle));
    return Array.from(fileIndices).filter(isInside);
  }

  /**
   * Returns the cloud on `engine`, and uploads it, as it was packed, if necessary. `user` keeps it until `release`.
   *
   * @throws GpuLimitError, DestroyedError.
   */
  acquire(engine: SplatEngine, user: object): SplatCloud {
    let upload = this.#uploads.get(engine);
    if (!upload) {
      const { packed, name } = this;
      // The copy in memory first: after the loss of a device, nothing is fetched that was packed finely enough.
      const source = this.#source === null ? packed : [packed, this.#source];
      const claimed = {
        geometryPrecision: packed.geometry.precision,
        shPrecision: packed.harmonics.precision,
        engineAccuracy: engine.accuracy,
        met: Promise.resolve(),
      };
      upload = { cloud: engine.addPacked(packed, { name, source }), users: new Map(), lease: null, claimed };
      this.#uploads.set(engine, upload);
    }
    if (!upload.users.has(user)) upload.users.set(user, null);
    return upload.cloud;
  }

  /** Releases the cloud that `user` acquired; the last release frees the GPU memory. */
  release(engine: SplatEngine, user: object): void {
    const upload = this.#uploads.get(engine);
    if (!upload?.users.delete(user)) return;
    if (upload.users.size > 0) {
      releaseUnneeded(upload);
      return;
    }
    this.#uploads.delete(engine);
    upload.cloud.destroy();
  }

  /**
   * @internal Makes the cloud that `user` has acquired hold the precision that `user` needs, and no less than its other
   * users need. Call it as often as you like: it returns the same promise until another precision is needed. Null: `user`
   * has no need of its own; others may then change the precision, so that the next need is claimed again.
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
      // `setAccuracy` makes the clouds' own leases claim a precision again, so this claim must release them again.
      claimed.engineAccuracy === engine.accuracy;
    if (isClaimed) return claimed.met;
    const met = claim(upload, { geometryPrecision, shPrecision });
    upload.claimed = { geometryPrecision, shPrecision, engineAccuracy: engine.accuracy, met };
    return met;
  }
}

/** Claims `precision`; when the cloud holds it, releases the cloud's own lease, so that the users alone decide. */
async function claim(upload: Upload, precision: CloudPrecision): Promise<void> {
  const { cloud, lease } = upload;
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
