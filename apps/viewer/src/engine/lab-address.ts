import { ADDRESS_NAMES } from './addressed-scene.ts';

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

/** URL of the page that runs this case, or all cases, on this device; null without a lab. */
export function conformanceAddress(name?: string): string | null {
  return LAB && [`${LAB}?conformance`, ...(name ? [`cases=${encodeURIComponent(name)}`] : [])].join('&');
}

/** URL in the lab of a page that has moved there from the viewer; null for other queries. */
export function movedAddress(query: URLSearchParams): string | null {
  return LAB && (query.has('bench') || query.has('conformance')) ? `${LAB}?${query}` : null;
}
