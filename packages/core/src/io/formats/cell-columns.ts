import { ROW_SLOT } from '../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';

/** Splats to be packed together. */
export interface CellColumns {
  readonly count: number;
  readonly shDegree: ShDegree;
  /** Numbers of their rows, with room for more. */
  readonly rows: Uint32Array<ArrayBuffer>;
  /** Their rows, one after another, with room for more. */
  readonly values: Float32Array<ArrayBuffer>;
}

/** Values of a row. */
export function widthOf(shDegree: ShDegree): number {
  return ROW_SLOT.harmonics + coefficientsPerSplat(shDegree);
}
