import { type MortonFrame, mortonCell } from '../packing/morton-order.ts';

/**
 * Reference of ingest-keys: for each splat of `order`, 24 bits of the 48-bit Morton code of its centre, bit by bit: the lower ones in
 * round 0, the upper ones in round 1, where dropped splats also have bit 24.
 */
export function ingestKeys(
  positions: Float32Array,
  order: Uint32Array,
  frame: MortonFrame,
  round: 0 | 1,
  isDropped: (splat: number) => boolean,
): Uint32Array {
  return order.map((splat) => {
    let key = round === 1 && isDropped(splat) ? 1 << 24 : 0;
    for (let axis = 0; axis < 3; axis++) {
      const cell = mortonCell(positions[3 * splat + axis], axis, frame) >> (8 * round);
      for (let bit = 0; bit < 8; bit++) key |= ((cell >> bit) & 1) << (3 * bit + axis);
    }
    return key;
  });
}
