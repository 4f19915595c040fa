import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { linkParts } from './level-link.ts';

/** The leaves of a cell above the chunks. */
export interface OpenLeaves {
  /** By place; 0 where there is none. */
  readonly links: readonly number[];
  readonly leastError: number;
  readonly uncounted: number;
}

/**
 * Reference of open-leaves, exact.
 *
 * @param errors of the cells below; 0 of those that are not on the GPU.
 */
export function openLeaves(links: readonly number[], errors: readonly number[]): OpenLeaves {
  const opened = links.map((link, place) => {
    if (link === 0) return 0;
    const { parentError, parentSlot } = linkParts(link);
    const error = errors[Math.floor(place / LEVEL_CONSTANTS.CELL_ROOTS)];
    return error + parentError * 2 ** 12 + parentSlot * 2 ** 24;
  });
  const own = opened.filter((link) => link !== 0).map((link) => linkParts(link).error);
  const closed = own.filter((error) => error === 0).length;
  return {
    links: opened,
    leastError: Math.min(...own),
    uncounted: closed > 0 ? links.length - closed : 0,
  };
}
