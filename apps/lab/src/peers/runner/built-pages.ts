import { BenchError } from './bench-error.ts';

/** A peer whose page is built. */
export interface BuiltPeer {
  readonly name: string;
  readonly isFloor: boolean;
  /** Null where the peer is no package. */
  readonly version: string | null;
  /** Address of its page from the root of all pages, options included. */
  readonly page: string;
}

/** The pages of a bench, which need neither packages nor sources. */
export interface BuiltPages {
  /** Of the checkout that they were built from; null outside of git. */
  readonly commit: string | null;
  /** Draws nothing: tells the ways of waiting apart. */
  readonly floor: BuiltPeer;
  readonly peers: readonly BuiltPeer[];
}

/** Names in a folder that `--pack` wrote, besides the bench. */
export const PAGES_FOLDER = 'pages';
export const PAGES_LIST = 'pages.json';
/** File at the root of all pages, without anything in it. */
export const BLANK_PAGE = 'blank.html';

/**
 * Those of the built `peers` that `text` names: `NAME`, `NAME?OPTIONS`, or `all`.
 *
 * @throws BenchError for a name that is not among them.
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
