import type { AccuracySettings } from '../accuracy/accuracy.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { SplatEngine } from '../engine.ts';
import { DestroyedError } from '../errors.ts';
import type { CloudPrecision } from '../packing/precision.ts';

/** What the clouds hold beyond what they held before. */
export interface HeldPlanes {
  /** What could not be had, in words. */
  readonly notes: readonly string[];
  /** Frees what was made for the measurement, but for these precisions as far as they could be had. */
  release(kept: CloudPrecision | null): Promise<void>;
}

/**
 * Makes `clouds` hold what all of `settings` ask for, the finest first, since the others are made of it. What cannot be
 * had, because a cloud's source is gone or its memory does not suffice, is told in a note and left alone.
 *
 * @throws DestroyedError, the reason of `signal`; what was made is freed then.
 */
export async function holdPlanes(
  engine: SplatEngine,
  clouds: readonly SplatCloud[],
  settings: readonly AccuracySettings[],
  signal: AbortSignal | undefined,
): Promise<HeldPlanes> {
  const notes: string[] = [];
  const distinct = [...new Set(clouds)];
  const before = new Map(distinct.map((cloud) => [cloud, cloud.precisions]));
  const release = async (kept: CloudPrecision | null) => {
    for (const [cloud, held] of before) {
      const { precisions } = cloud;
      const geometry = precisions.geometry.filter(
        (precision) => held.geometry.includes(precision) || precision === kept?.geometryPrecision,
      );
      const sh = precisions.sh.filter(
        (precision) => held.sh.includes(precision) || precision === kept?.shPrecision,
      );
      const isLarger = precisions.geometry.length > geometry.length || precisions.sh.length > sh.length;
      if (cloud.isDestroyed || !isLarger) continue;
      // Frees all but the finest of those that stay; the others are made of that again, on the GPU.
      const finest = { geometryPrecision: geometry[0], shPrecision: sh[0] };
      await engine.requestPrecision(cloud, finest).catch(() => {});
      for (const geometryPrecision of geometry.slice(1))
        await engine
          .requestPrecision(cloud, { ...finest, geometryPrecision }, { keep: true })
          .catch(() => {});
      for (const shPrecision of sh.slice(1))
        await engine.requestPrecision(cloud, { ...finest, shPrecision }, { keep: true }).catch(() => {});
    }
  };
  try {
    for (const cloud of distinct) {
      const wanted = new Map<string, AccuracySettings>();
      for (const each of settings) wanted.set(`${each.geometryPrecision} ${each.shPrecision}`, each);
      for (const { geometryPrecision, shPrecision } of wanted.values()) {
        const { geometry, sh } = cloud.precisions;
        if (geometry.includes(geometryPrecision) && sh.includes(shPrecision)) continue;
        await engine
          .requestPrecision(cloud, { geometryPrecision, shPrecision }, { signal, keep: true })
          .catch((error: Error) => {
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
