import { BenchError } from './bench-error.ts';

/** A peer whose page is built. */
export interface BuiltPeer {
  readonly name: string;
  readonly isFloor: boolean;
  /** Null if the peer is no package. */
  readonly version: string | null;
  /** Address of its page from the root of all pages, options included. */
  readonly page: string;
}

/** The pages of a bench, which need neither packages nor sources. */
export interface BuiltPages {
  /** Commit of the checkout that the pages were built from; null outside of git. */
  readonly commit: string | null;
  /** Draws nothing: tells the ways of waiting apart. */
  readonly floor: BuiltPeer;
  readonly peers: readonly BuiltPeer[];
}

/** Names in a folder that `--pack` wrote, besides the bench. */
export const PAGES_FOLDER = 'pages';
export const PAGES_LIST = 'pages.json';
/** An empty file at the root of all pages. */
export const BLANK_PAGE = 'blank.html';

/**
 * Chooses the built peers that `text` names: `NAME`, `NAME?OPTIONS`, or `all`.
 *
 * @throws BenchError if a name is not among `peers`.
 */
export function chooseBuilt(text: string, peers: readonly BuiltPeer[]): BuiltPeer[] {
  if (text === 'all') return [...peers];
  return text.split(',').map((word) => {
    const same = peers.find(({ name }) => name === word);
    if (same) return same;
    const [, base, options] = /^([^?]+)\?(.+)$/.exec(word) ?? [];
    const peer = peers.find(({ name }) => name === base);
    if (!peer)
      throw new BenchError(
        `--peers has "${word}"; this pack has ${peers.map(({ name }) => name).join(', ')}.`,
      );
    const separator = peer.page.endsWith('?') ? '' : '&';
    return { ...peer, name: word, page: `${peer.page}${separator}${options}` };
  });
}
