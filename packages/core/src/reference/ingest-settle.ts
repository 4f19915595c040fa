import { type PackedGeometry, packGeometry } from '../packing/geometry.ts';
import type { GeometryPrecision } from '../packing/precision.ts';
import type { SplatColumns } from '../splats/splat-set.ts';

/** Reference of ingest-settle: the host's packer, for splats about `origin`, with their own range of log scales. */
export function ingestSettle(
  set: SplatColumns,
  geometryPrecision: GeometryPrecision,
  origin: SplatColumns['origin'],
): PackedGeometry {
  const positions = set.positions.map((value, i) => value - origin[i % 3]);
  return packGeometry({ ...set, positions, origin }, geometryPrecision);
}
