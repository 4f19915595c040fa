import type { GridPlan } from './collider-grid.ts';

/** A collider's options and bounds; the splats follow. */
export interface ColliderPlan {
  readonly grid: GridPlan;
  /** Origin of the geometry, which its positions are relative to. */
  readonly origin: readonly number[];
  readonly solidAt: number;
  readonly fewestTriangles: number;
}
