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
  /** What each user needs the cloud to hold; null of those who leave that to others. */
  readonly users: Map<object, CloudPrecision | null>;
  /** Claims what the users need; null before any of them needs more than was uploaded. */
  lease: CloudLease | null;
  /** What was claimed last, under which accuracy of the engine, and what becomes of it; null: nothing is. */
  asked: (CloudPrecision & { readonly engineAccuracy: object; readonly answer: Promise<void> }) | null;
}

/**
 * Splats in memory, and on the GPU of each engine that draws them: uploaded for the first user, freed after the last. The
 * copy in memory stays, so that another renderer, or the next one after a lost device, needs no second download.
 */
export class SplatData {
  /** For messages and labels. */
  readonly name: string;
  readonly packed: PackedCloud;
  /** Of the centres, in the cloud's own space. */
  readonly bounds: Box3;
  /** The same without the outermost splats: where the scene is. */
  readonly robustBounds: Box3;
  readonly #source: CloudSource | null;
  readonly #uploads = new Map<SplatEngine, Upload>();

  /**
   * @param source where the same splats can be read again for a finer precision than that of `packed`; kept by reference.
   *   Without one they are drawn no finer than they were packed.
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

  /** Rows of the splats whose centres are in a volume of the cloud's own space, as a SplatSelection takes them. Asks each. */
  rowsIn(volume: Box3 | Sphere): number[] {
    const { geometry, origin, fileIndices } = this.packed;
    // Whatever the precision, a splat begins with its position in float32.
    const values = new Float32Array(geometry.words.buffer, geometry.words.byteOffset, geometry.words.length);
    const stride = GEOMETRY_WORDS[geometry.precision];
    const middle = new Vector3(...origin);
    const center = new Vector3();
    const isInside = (_row: number, i: number) =>
      volume.containsPoint(center.fromArray(values, stride * i).add(middle));
    return Array.from(fileIndices).filter(isInside);
  }

  /**
   * The cloud on `engine`, uploaded as it was packed where it is not there yet, for `user` until it calls `release`.
   *
   * @throws GpuLimitError, DestroyedError.
   */
  acquire(engine: SplatEngine, user: object): SplatCloud {
    let upload = this.#uploads.get(engine);
    if (!upload) {
      const { packed, name } = this;
      // What is in memory anyway first: after the loss of a device nothing is fetched that was packed finely enough.
      const source = this.#source === null ? packed : [packed, this.#source];
      const asked = {
        geometryPrecision: packed.geometry.precision,
        shPrecision: packed.harmonics.precision,
        engineAccuracy: engine.accuracy,
        answer: Promise.resolve(),
      };
      upload = { cloud: engine.addPacked(packed, { name, source }), users: new Map(), lease: null, asked };
      this.#uploads.set(engine, upload);
    }
    if (!upload.users.has(user)) upload.users.set(user, null);
    return upload.cloud;
  }

  /** Gives back what `acquire` gave to `user`; the last one frees the GPU's memory. */
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
   * @internal Has the cloud that `user` has acquired hold what it needs, and no less than its other users need. May be
   * called as often as wanted: the answer is the same promise until something else is asked for. Null: `user` leaves that
   * to others, who may have changed it when it is no longer null.
   *
   * @returns as the `met` of a lease; null where nothing was asked for.
   */
  hold(engine: SplatEngine, user: object, precision: CloudPrecision | null): Promise<void> | null {
    const upload = this.#uploads.get(engine)!;
    const { users } = upload;
    if (precision === null) {
      if (users.get(user)) upload.asked = null;
      users.set(user, null);
      releaseUnneeded(upload);
      return null;
    }
    users.set(user, precision);
    const needed = [...users.values()].filter((each) => each !== null);
    const { geometryPrecision, shPrecision } = mostExact(needed);
    const { asked } = upload;
    const isAsked =
      asked?.geometryPrecision === geometryPrecision &&
      asked.shPrecision === shPrecision &&
      // Whoever changes that makes all clouds of the engine claim it.
      asked.engineAccuracy === engine.accuracy;
    if (isAsked) return asked.answer;
    const answer = claim(upload, { geometryPrecision, shPrecision });
    upload.asked = { geometryPrecision, shPrecision, engineAccuracy: engine.accuracy, answer };
    return answer;
  }
}

/** Resolves when the cloud holds `precision` and nothing that only its own lease claims: the users decide alone. */
async function claim(upload: Upload, precision: CloudPrecision): Promise<void> {
  const { cloud, lease } = upload;
  if (lease) lease.change(precision);
  else upload.lease = cloud.hold(precision);
  await upload.lease!.met;
  cloud.ownLease.release();
}

/** Where all users leave that to others, nothing is claimed for them. */
function releaseUnneeded(upload: Upload): void {
  const isNeeded = [...upload.users.values()].some((precision) => precision !== null);
  if (isNeeded || !upload.lease) return;
  upload.lease.release();
  upload.asked = null;
}

function boxOf({ min, max }: PackedCloud['bounds']): Box3 {
  return new Box3(new Vector3(...min), new Vector3(...max));
}
