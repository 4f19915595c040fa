import { type MortonFrame, mortonCell } from '../data/packing/morton-order.ts';

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
