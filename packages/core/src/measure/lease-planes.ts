import type { CloudLease } from '../clouds/cloud-leases.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import { DestroyedError } from '../data/errors.ts';
import type { CloudPrecision } from '../data/packing/precision.ts';

/** The planes that a measurement compares. */
export interface LeasedPlanes {
  /** Sentences that say why precisions are missing. */
  readonly notes: readonly string[];
  /**
   * Releases the measurement's leases. Each cloud's own lease then also claims `kept`, or the
   * nearest precision to it among the measured planes.
   */
  release(kept: CloudPrecision | null): Promise<void>;
}

/**
 * Leases the precisions of all `settings`, the finest first, since the others are made of it.
 * Precisions that cannot be made, because a cloud's source is gone or memory does not suffice, are
 * skipped and get a note.
 *
 * @throws DestroyedError, the reason of `signal`; on failure nothing stays leased.
 */
export async function leasePlanes(
  clouds: readonly SplatCloud[],
  settings: readonly AccuracySettings[],
  signal: AbortSignal | undefined,
): Promise<LeasedPlanes> {
  const notes: string[] = [];
  const leases: CloudLease[] = [];
  const distinct = [...new Set(clouds)];
  const release = async (kept: CloudPrecision | null) => {
    if (kept) {
      const precisions = distinct.map((cloud) => cloud.ownLease.add(cloud.pagesFor(kept)));
      // All these planes are held: this can fail only if the cloud is gone.
      await Promise.allSettled(precisions);
    }
    for (const lease of leases) lease.release();
  };
  const wanted = new Map<string, AccuracySettings>();
  for (const each of settings) wanted.set(`${each.geometryPrecision} ${each.shPrecision}`, each);
  try {
    for (const cloud of distinct) {
      for (const precision of wanted.values()) {
        const lease = cloud.hold(precision, { signal });
        leases.push(lease);
        await lease.met.catch((error: Error) => {
          signal?.throwIfAborted();
          if (error instanceof DestroyedError) throw error;
          if (!notes.includes(error.message)) notes.push(error.message);
        });
      }
    }
    return { notes, release };
  } catch (error) {
    await release(null);
    throw error;
  }
}
