import type { GridPlan } from './collider-grid.ts';

/** The options and bounds of a collider, sent before its splats. */
export interface ColliderPlan {
  readonly grid: GridPlan;
  /** Point that positions of the geometry are relative to. */
  readonly origin: readonly number[];
  readonly solidAt: number;
  readonly fewestTriangles: number;
}
