import type { SceneSource } from '../open/scene-source.ts';

/**
 * The scene that the page's URL asks for: `?src=URL` once or more often, `?scene=NAME` or
 * `?scene=hard:NAME`.
 */
export interface AddressedScene {
  /** Files embedded in the page, used instead of files that the URL names. */
  readonly held?: readonly SceneSource[];
  /** URLs of files, absolute or relative to the page; all are shown as one scene. */
  readonly addresses?: readonly string[];
  readonly scene?: string | null;
}

/**
 * Query parameters that hold a file's URL. `src` is this viewer's; the others are names that other
 * viewers use.
 */
export const ADDRESS_NAMES = ['src', 'url', 'file'] as const;

/** Reads the query of the page's URL. */
export function addressedScene(query: URLSearchParams): AddressedScene {
  const addresses = ADDRESS_NAMES.flatMap((name) => query.getAll(name)).filter((address) => address !== '');
  return { addresses, scene: query.get('scene') };
}
