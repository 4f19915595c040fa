import type { DropReason } from './splat-set.ts';

/** Layout of one splat's values in one array: index of each property's first component. */
export const ROW_SLOT = {
  /** x, y, z in the scene's space. */
  position: 0,
  /** 3 natural logarithms. */
  logScale: 3,
  /** w, x, y, z. */
  rotation: 6,
  /** Logit. */
  opacity: 10,
  /** r, g, b. */
  colorDc: 11,
  /** 3K values in ascending (degree, order), each as r, g, b. */
  harmonics: 14,
} as const;

/**
 * Why these values cannot be drawn; undefined if they can. Logits of ±∞ mean opacity 0 or 1, a log
 * scale of −∞ a scale of 0.
 */
export function reasonToDrop(row: Float64Array | Float32Array): DropReason | undefined {
  if (!isFiniteFloat32(row, ROW_SLOT.position, 3)) return 'non-finite-position';
  for (let i = ROW_SLOT.logScale; i < ROW_SLOT.logScale + 3; i++)
    if (!(Math.fround(row[i]) < Number.POSITIVE_INFINITY)) return 'non-finite-scale';
  if (!isFiniteFloat32(row, ROW_SLOT.rotation, 4)) return 'non-finite-rotation';
  if (Number.isNaN(row[ROW_SLOT.opacity])) return 'non-finite-opacity';
  if (!isFiniteFloat32(row, ROW_SLOT.colorDc, row.length - ROW_SLOT.colorDc)) return 'non-finite-color';
  return undefined;
}

/** Checks in float32: a finite double can still be too large for a column. */
function isFiniteFloat32(values: Float64Array | Float32Array, from: number, count: number): boolean {
  for (let i = from; i < from + count; i++) if (!Number.isFinite(Math.fround(values[i]))) return false;
  return true;
}
