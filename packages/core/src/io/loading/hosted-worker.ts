/** Makes the worker that the page hosts; null where bundler and package provide the workers. */
let make: (() => Worker) | null = null;

/**
 * Sets where this page hosts `@websplatter/core/load-worker`, the one script that reads every
 * format and makes colliders. It is for pages whose bundler leaves workers out, and holds for all
 * later loads of all engines; call it before the first.
 *
 * If no worker starts from there, the console says so once, and the page's own thread works.
 *
 * @param url resolved against the page. It may be of another origin that allows this one to read it
 * (CORS), as content networks do. Null, the default: the workers that the bundler found, or those
 * beside the package's entry.
 */
export function setWorkerUrl(url: string | URL | null): void {
  make = url ? () => new Worker(url, { type: 'module' }) : null;
}

/** Makes the worker that the page hosts; null if it hosts none. */
export const hostedWorker = (): typeof make => make;
