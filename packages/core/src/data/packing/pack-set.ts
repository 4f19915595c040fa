import { givenSet } from '../splats/check-set.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { dropNonFinite } from './drop-non-finite.ts';
import type { Harmonics } from './harmonics.ts';
import { type PackedCloud, packCloud } from './packed-cloud.ts';
import type { CloudPrecision } from './precision.ts';

/**
 * Packs splats in memory, in any order. Splats that are not finite are dropped and counted.
 *
 * @hidden Shared with the packages beside this one.
 */
export function packSet(set: SplatSet<Harmonics>, precision: CloudPrecision): PackedCloud {
  return packCloud(dropNonFinite(givenSet(set)), precision);
}
