/** Neither a page nor a worker: nothing can be fetched for it or drawn. */
export function isServer(): boolean {
  return !('document' in globalThis || 'importScripts' in globalThis);
}
