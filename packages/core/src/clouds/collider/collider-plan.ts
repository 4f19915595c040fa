import type { GridPlan } from './collider-grid.ts';

/** What a collider is made of, besides splats. */
export interface ColliderPlan {
  readonly grid: GridPlan;
  /** Of the geometry: what its positions are relative to. */
  readonly origin: readonly number[];
  readonly solidAt: number;
  readonly fewestTriangles: number;
}
