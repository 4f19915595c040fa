import { type PackedGeometry, packGeometry } from '../../data/packing/geometry.ts';
import type { PackedHarmonics } from '../../data/packing/harmonics.ts';
import { type MortonFrame, mortonCell } from '../../data/packing/morton-order.ts';
import type { GeometryPrecision, RowPrecision } from '../../data/packing/precision.ts';
import { packHarmonics, repackHarmonics } from '../../data/packing/repack-harmonics.ts';
import type { SplatColumns, SplatSet } from '../../data/splats/splat-set.ts';

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

/**
 * Reference of ingest-keys: for each splat of `order`, eight bits of the 48-bit Morton code of its
 * centre, bit by bit: the lowest in round 0, the highest in round 5, where dropped splats also have
 * bit 8.
 */
export function ingestKeys(
  positions: Float32Array,
  order: Uint32Array,
  frame: MortonFrame,
  round: number,
  isDropped: (splat: number) => boolean,
): Uint32Array {
  return order.map((splat) => {
    const cells = [0, 1, 2].map((axis) => mortonCell(positions[3 * splat + axis], axis, frame));
    let key = round === 5 && isDropped(splat) ? 1 << 8 : 0;
    for (let bit = 0; bit < 8; bit++) {
      const ofCode = 8 * round + bit;
      key |= ((cells[ofCode % 3] >> Math.floor(ofCode / 3)) & 1) << bit;
    }
    return key;
  });
}

/**
 * Reference of ingest-scatter: `plane` with `words` as the `count` words from `word` on of its
 * splats.
 */
export function ingestScatter(
  plane: Uint32Array,
  wordsPerSplat: number,
  word: number,
  count: number,
  words: Uint32Array,
): Uint32Array {
  return plane.map((value, i) => {
    const place = (i % wordsPerSplat) - word;
    return place >= 0 && place < count ? words[count * Math.floor(i / wordsPerSplat) + place] : value;
  });
}

/** Reference of ingest-chunks: the host's packer, in storage order, of exact log scales. */
export function ingestChunks(
  set: SplatColumns,
  geometryPrecision: GeometryPrecision,
  origin: SplatColumns['origin'],
): PackedGeometry {
  const positions = set.positions.map((value, i) => value - origin[i % 3]);
  return packGeometry({ ...set, positions, origin }, geometryPrecision);
}
