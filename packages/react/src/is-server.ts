/** Whether this is neither a page nor a worker, so that nothing can be fetched or drawn. */
export function isServer(): boolean {
  return !('document' in globalThis || 'importScripts' in globalThis);
}
