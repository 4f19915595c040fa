import type { CloudPrecision } from './cloud-planes.ts';
import { dropNonFinite } from './drop-non-finite.ts';
import { type PackedCloud, packCloud } from './packed-cloud.ts';
import type { SplatSet } from './splat-set.ts';

/** Packs splats that are in memory, of any order; what is not finite is left out and counted. */
export function packSet(set: SplatSet, { geometryPrecision, shPrecision }: CloudPrecision): PackedCloud {
  return packCloud(dropNonFinite(set), { geometryPrecision, shPrecision });
}
