import type { SceneSource } from './scene-source.ts';

/** The address's scene: `?src=ADDRESS`, once or more often, `?scene=NAME`, `?scene=hard:NAME`. */
export interface AddressedScene {
  /** Files that the page holds itself, in place of those of an address. */
  readonly held?: readonly SceneSource[];
  /** Of files, relative to the page or whole; they are shown together. */
  readonly addresses?: readonly string[];
  readonly scene?: string | null;
}

/** Names that addresses of files have in a page's address: other viewers use the others. */
export const ADDRESS_NAMES = ['src', 'url', 'file'] as const;

/** `?scene=hard` is the gallery, `?scene=hard:NAME` a case. */
export const GALLERY_SCENE = 'hard';

/** Reads the query of the page's address. */
export function addressedScene(query: URLSearchParams): AddressedScene {
  const addresses = ADDRESS_NAMES.flatMap((name) => query.getAll(name)).filter((address) => address !== '');
  return { addresses, scene: query.get('scene') };
}

/** Whether the query of the page's address asks for the gallery of hard cases. */
export function asksForGallery(query: URLSearchParams): boolean {
  const { addresses, scene } = addressedScene(query);
  return scene === GALLERY_SCENE && addresses?.length === 0;
}
