import type { PostedError } from '../io/loading/load-messages.ts';
import type { PackedGeometry } from '../packing/geometry.ts';
import type { GridPlan } from './collider-grid.ts';
import type { Triangles } from './collider-surface.ts';

/** What a collider is made of, besides splats. */
export interface ColliderPlan {
  readonly grid: GridPlan;
  /** Of the geometry: what its positions are relative to. */
  readonly origin: readonly number[];
  readonly solidAt: number;
  readonly fewestTriangles: number;
}

/** Page to worker: the plan, the splats in pieces, and their end. The next message follows the answer to the last one. */
export type ColliderRequest =
  | { readonly collider: 'plan'; readonly plan: ColliderPlan }
  | { readonly collider: 'piece'; readonly piece: PackedGeometry }
  | { readonly collider: 'end' };

/** Worker to page. */
export type ColliderReply =
  /** The worker's script is running. */
  | { readonly kind: 'ready' }
  /** The worker has taken what was posted, and waits for more. */
  | { readonly kind: 'taken' }
  | { readonly kind: 'mesh'; readonly mesh: Triangles }
  | { readonly kind: 'error'; readonly error: PostedError };
