/** Splats that share their bounds. */
export const CHUNK_ROWS = 256;

/** Values with bounds in each chunk, in the order that readers expect. */
export const BOUNDED = {
  position: ['x', 'y', 'z'],
  logScale: ['scale_x', 'scale_y', 'scale_z'],
  color: ['r', 'g', 'b'],
} as const;

/** Properties of a splat, each 32 bits. */
export const PACKED = ['packed_position', 'packed_rotation', 'packed_scale', 'packed_color'];

/** Least values, then greatest. */
export function boundsNames(stems: readonly string[]): string[] {
  return [...stems.map((stem) => `min_${stem}`), ...stems.map((stem) => `max_${stem}`)];
}
