import { type PackedGeometry, packGeometry } from '../data/packing/geometry.ts';
import type { GeometryPrecision } from '../data/packing/precision.ts';
import type { SplatColumns } from '../data/splats/splat-set.ts';

/** Reference of ingest-chunks: the host's packer, for splats in storage order about `origin`, from log scales before they were rounded. */
export function ingestChunks(
  set: SplatColumns,
  geometryPrecision: GeometryPrecision,
  origin: SplatColumns['origin'],
): PackedGeometry {
  const positions = set.positions.map((value, i) => value - origin[i % 3]);
  return packGeometry({ ...set, positions, origin }, geometryPrecision);
}
