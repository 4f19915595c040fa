import { type PackedGeometry, packGeometry } from '../data/packing/geometry.ts';
import type { PackedHarmonics } from '../data/packing/harmonics.ts';
import type { RowPrecision } from '../data/packing/precision.ts';
import { packHarmonics, repackHarmonics } from '../data/packing/repack-harmonics.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';

/**
 * Reference of ingest-rows for rows that are kept: the host's own packers, in float64, for chunks
 * in the order of the file.
 */
export function ingestRows(
  set: SplatSet,
  { geometryPrecision, shPrecision }: RowPrecision,
): { readonly geometry: PackedGeometry; readonly harmonics: PackedHarmonics } {
  return {
    geometry: packGeometry(set, geometryPrecision),
    harmonics: repackHarmonics(packHarmonics(set.harmonics), set.count, shPrecision),
  };
}
