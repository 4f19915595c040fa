import type { FileFacts } from './splat-set.ts';

/** Values of `SortBy`. */
export const SORTED_BY = ['auto', 'depth', 'distance'] as const;

/**
 * Sort key of a frame's splats, farthest first: their depths along the camera's axis, as in most
 * training, or their distances from the camera; `auto`: distances where a file asks for them
 * (`FileFacts.isSortedByDistance`), depths otherwise. Without perspective both orders are one.
 */
export type SortBy = (typeof SORTED_BY)[number];

/** The part of a frame request that decides the order. */
interface SortedFrame {
  readonly sortBy?: SortBy;
  readonly clouds: readonly {
    readonly cloud: { readonly facts: { readonly fileFacts: FileFacts | null } };
  }[];
}

/** Whether splats are to be sorted by distance, if the camera has perspective. */
export function asksForDistance({ sortBy = 'auto', clouds }: SortedFrame): boolean {
  return sortBy === 'auto'
    ? clouds.some(({ cloud }) => cloud.facts.fileFacts?.isSortedByDistance)
    : sortBy === 'distance';
}
