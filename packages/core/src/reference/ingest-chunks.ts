import { type PackedGeometry, packGeometry } from '../data/packing/geometry.ts';
import type { GeometryPrecision } from '../data/packing/precision.ts';
import type { SplatColumns } from '../data/splats/splat-set.ts';

/** Reference of ingest-chunks: the host's packer, in storage order, of exact log scales. */
export function ingestChunks(
  set: SplatColumns,
  geometryPrecision: GeometryPrecision,
  origin: SplatColumns['origin'],
): PackedGeometry {
  const positions = set.positions.map((value, i) => value - origin[i % 3]);
  return packGeometry({ ...set, positions, origin }, geometryPrecision);
}
