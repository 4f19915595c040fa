import { ADDRESS_NAMES } from './addressed-scene.ts';

/** The viewer as one file has nothing beside it. */
export const IS_ONE_FILE: boolean = import.meta.env.WEBSPLATTER_ALONE ?? false;
const LAB = IS_ONE_FILE ? null : 'lab/';

/** Parts of an address that the viewer and the benchmark both read. */
const SHARED_NAMES: readonly string[] = [...ADDRESS_NAMES, 'scene', 'accuracy'];

/** The benchmark of the scene and the accuracy of the viewer's address; null without a lab. */
export function benchmarkAddress(query: URLSearchParams): string | null {
  const shared = [...query].filter(([name]) => SHARED_NAMES.includes(name));
  return LAB && [`${LAB}?bench`, ...(shared.length > 0 ? [new URLSearchParams(shared)] : [])].join('&');
}

/** The page that runs this case, or all of them, on this device; null where there is no lab. */
export function conformanceAddress(name?: string): string | null {
  return LAB && [`${LAB}?conformance`, ...(name ? [`cases=${encodeURIComponent(name)}`] : [])].join('&');
}

/** The lab's page for one that the viewer had before, at this query; null for others. */
export function movedAddress(query: URLSearchParams): string | null {
  return LAB && (query.has('bench') || query.has('conformance')) ? `${LAB}?${query}` : null;
}
