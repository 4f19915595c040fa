import type { SomeColumns } from '../splats/splat-set.ts';
import { chunkCountOf, chunksOf, logScalesOf, setLogScales } from './chunks.ts';
import { isIsotropic } from './cloud-facts.ts';
import { putColumns } from './geometry.ts';
import { type PackedCloud, sampledBounds, totalBounds } from './packed-cloud.ts';

/**
 * Returns a copy of a cloud in which some columns of all splats are others, in storage order. Packing
 * these alone is quicker than packing a cloud.
 *
 * @param columns log scales come with positions, because a chunk tells about both.
 */
export function changedCloud(cloud: PackedCloud, columns: SomeColumns): PackedCloud {
  const copy = structuredClone(cloud);
  const { count, origin, geometry, facts, robustBounds } = copy;
  const { positions, logScales } = columns;
  if (positions) {
    const chunks = chunksOf({ count, positions, logScales: logScales ?? positions });
    for (let chunk = 0; chunk < chunkCountOf(count) && !logScales; chunk++)
      setLogScales(chunks, chunk, logScalesOf(geometry.chunks, chunk));
    geometry.chunks.set(chunks);
  }
  putColumns(geometry, columns);
  return {
    ...copy,
    bounds: totalBounds(copy.chunks, origin),
    robustBounds: positions ? sampledBounds({ count, origin, positions }) : robustBounds,
    facts: logScales ? { ...facts, isIsotropic: isIsotropic({ count, logScales }) } : facts,
  };
}
