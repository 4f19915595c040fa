import { isDrawnAt } from './level-link.ts';

/** Reference of cut-splats: which of the splats with these links a cut at `limit` goes through. */
export function cutSplats(links: readonly number[], limit: number): boolean[] {
  return links.map((link) => isDrawnAt(link, limit));
}
