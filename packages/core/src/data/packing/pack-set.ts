import type { SplatSet } from '../splats/splat-set.ts';
import { dropNonFinite } from './drop-non-finite.ts';
import type { Harmonics } from './harmonics.ts';
import { type PackedCloud, packCloud } from './packed-cloud.ts';
import type { CloudPrecision } from './precision.ts';

/** Packs splats in memory, in any order. Those that are not finite are dropped and counted. */
export function packSet(
  set: SplatSet<Harmonics>,
  { geometryPrecision, shPrecision }: CloudPrecision,
): PackedCloud {
  return packCloud(dropNonFinite(set), { geometryPrecision, shPrecision });
}
