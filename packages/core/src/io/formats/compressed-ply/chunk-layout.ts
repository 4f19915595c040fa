/** Splats per chunk. */
export const CHUNK_ROWS = 256;

/** Bounded values of a chunk, in the order that readers expect. */
export const BOUNDED = {
  position: ['x', 'y', 'z'],
  logScale: ['scale_x', 'scale_y', 'scale_z'],
  color: ['r', 'g', 'b'],
} as const;

/** Properties of a splat, 32 bits each. */
export const PACKED = ['packed_position', 'packed_rotation', 'packed_scale', 'packed_color'];

/** Names of the least values, then of the greatest. */
export function boundsNames(stems: readonly string[]): string[] {
  return [...stems.map((stem) => `min_${stem}`), ...stems.map((stem) => `max_${stem}`)];
}
