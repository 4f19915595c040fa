import { ADDRESS_NAMES, addressedScene } from './addressed-scene.ts';

/** Whether this is the viewer in one file, which has no lab beside it. */
export const IS_ONE_FILE: boolean = import.meta.env.WEBSPLATTER_ALONE ?? false;
const LAB = IS_ONE_FILE ? null : 'lab/';

/** Query parameters that the viewer and the benchmark both read. */
const SHARED_NAMES: readonly string[] = [...ADDRESS_NAMES, 'scene', 'accuracy'];

/** URL of the benchmark for the scene and accuracy in the viewer's query; null without a lab. */
export function benchmarkAddress(query: URLSearchParams): string | null {
  const shared = [...query].filter(([name]) => SHARED_NAMES.includes(name));
  return LAB && [`${LAB}?bench`, ...(shared.length > 0 ? [new URLSearchParams(shared)] : [])].join('&');
}

/** URL of the page of this hard case, or of the gallery of all cases; null without a lab. */
export function galleryAddress(name?: string): string | null {
  return LAB && [`${LAB}?gallery`, ...(name ? [`case=${encodeURIComponent(name)}`] : [])].join('&');
}

/**
 * URL in the lab of a page that has moved there from the viewer: `?bench`, `?conformance`, and the
 * gallery of hard cases, `?scene=hard`. Null for other queries, and without a lab.
 */
export function movedAddress(query: URLSearchParams): string | null {
  if (!LAB) return null;
  if (query.has('bench') || query.has('conformance')) return `${LAB}?${query}`;
  const { addresses, scene } = addressedScene(query);
  if (scene !== 'hard' || addresses?.length !== 0) return null;
  const others = [...query].filter(([name]) => name !== 'scene');
  return `${LAB}?${new URLSearchParams([['gallery', ''], ...others])}`;
}
