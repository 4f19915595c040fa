import type { AccuracySettings } from '../accuracy/accuracy.ts';
import type { CloudLease } from '../clouds/cloud-leases.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { DestroyedError } from '../errors.ts';
import type { CloudPrecision } from '../packing/precision.ts';

/** The planes that a measurement compares. */
export interface LeasedPlanes {
  /** Why precisions are missing, for people. */
  readonly notes: readonly string[];
  /**
   * Gives up the measurement's claims. The cloud's own lease then claims `kept` too, or what comes nearest to it among the
   * planes that were measured.
   */
  release(kept: CloudPrecision | null): Promise<void>;
}

/**
 * Claims what all of `settings` ask for, the finest first, since the others are made of it. A note says which precision
 * cannot be had, because a cloud's source is gone or its memory does not suffice; the measurement goes on without it.
 *
 * @throws DestroyedError, the reason of `signal`; nothing stays claimed then.
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
      // All of it is held: that can fail only where the cloud is gone.
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
