import { type PackedGeometry, packGeometry } from '../packing/geometry.ts';
import type { PackedHarmonics } from '../packing/harmonics.ts';
import { INGEST_LOG_SCALES } from '../packing/ingest-log-scale.ts';
import type { RowPrecision } from '../packing/precision.ts';
import { packHarmonics, repackHarmonics } from '../packing/repack-harmonics.ts';
import type { SplatSet } from '../splats/splat-set.ts';

/**
 * Reference of ingest-rows for rows that are kept: the host's own packers, in float64. Log scales are packed over all that a splat
 * may have.
 */
export function ingestRows(
  set: SplatSet,
  { geometryPrecision, shPrecision }: RowPrecision,
): { readonly geometry: PackedGeometry; readonly harmonics: PackedHarmonics } {
  return {
    geometry: packGeometry(set, geometryPrecision, INGEST_LOG_SCALES),
    harmonics: repackHarmonics(packHarmonics(set.harmonics), set.count, shPrecision),
  };
}
