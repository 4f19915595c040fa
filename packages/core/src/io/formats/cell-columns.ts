import { ROW_SLOT } from '../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';

/** Splats to be packed together. */
export interface CellColumns {
  readonly count: number;
  readonly shDegree: ShDegree;
  /** Row indices in the file; may be longer than `count`. */
  readonly rows: Uint32Array<ArrayBuffer>;
  /** Rows, one after another; may be longer than needed. */
  readonly values: Float32Array<ArrayBuffer>;
}

/** Number of values per row. */
export function widthOf(shDegree: ShDegree): number {
  return ROW_SLOT.harmonics + coefficientsPerSplat(shDegree);
}
