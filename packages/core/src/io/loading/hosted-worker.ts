/** Makes the self-hosted worker; null if bundler and package provide the workers. */
let make: (() => Worker) | null = null;

/**
 * Sets the URL of a self-hosted `@websplatter/core/load-worker`, the single script that reads every
 * format and builds colliders. Use it if the bundler cannot emit workers. It affects all later
 * loads of all engines, so call it before the first load.
 *
 * If no worker starts from this URL, one console message says so, and the main thread does the
 * work.
 *
 * @param url resolved against the page. Another origin must allow reads by CORS, as CDNs do. Null,
 *   the default: the workers that the bundler emitted or that lie beside the package's entry.
 * @example
 * setWorkerUrl('/assets/load-worker.js');
 * const cloud = await engine.load('/garden.ply');
 */
export function setWorkerUrl(url: string | URL | null): void {
  make = url ? () => new Worker(url, { type: 'module' }) : null;
}

/** Makes the self-hosted worker; null if `setWorkerUrl` was not called. */
export const hostedWorker = (): typeof make => make;
