import { WebSplatterError } from '../../data/errors.ts';
import { baseUrl } from '../sources/known-source.ts';

// Fetched only if a worker does not start.

let wasReported = false;

/**
 * Retries a worker that `make` could not start because its script is on another origin: a Blob of
 * the page's own origin imports the script. Resolves with null if that fails too. The first failure
 * prints advice to the console.
 *
 * Rejects as `start`.
 */
export async function startElsewhere(
  make: () => Worker,
  start: (make: () => Worker) => Promise<Worker | null>,
): Promise<Worker | null> {
  const address = addressOf(make);
  const worker = address && isOfOtherOrigin(address) ? await startFromBlob(address, start) : null;
  if (!worker && !wasReported) {
    wasReported = true;
    console.warn(workerUnavailable(address));
  }
  return worker;
}

/** URL of the script that `make` requests, which only its bundler knows; null if `make` fails before. */
function addressOf(make: () => Worker): URL | null {
  let asked: string | URL | null = null;
  const { Worker } = globalThis;
  globalThis.Worker = class {
    constructor(url: string | URL) {
      asked = url;
    }
  } as unknown as typeof Worker;
  try {
    make();
    return asked && new URL(asked, baseUrl());
  } catch {
    // The bundler has left the script out: the message below says so.
    return null;
  } finally {
    globalThis.Worker = Worker;
  }
}

function isOfOtherOrigin({ protocol, origin }: URL): boolean {
  return /^https?:$/.test(protocol) && origin !== globalThis.location?.origin;
}

async function startFromBlob(
  address: URL,
  start: (make: () => Worker) => Promise<Worker | null>,
): Promise<Worker | null> {
  const script = new Blob([`import ${JSON.stringify(address.href)};`], { type: 'text/javascript' });
  const url = URL.createObjectURL(script);
  try {
    return await start(() => new Worker(url, { type: 'module' }));
  } finally {
    URL.revokeObjectURL(url);
  }
}

function workerUnavailable(address: URL | null): WebSplatterError {
  const found = address ? `${address.href} did not start as a worker` : 'the bundler left the workers out';
  return new WebSplatterError(
    'worker-unavailable',
    `WebSplatter: ${found}, so files are read on the main thread, which then stutters. Serve the file ` +
      '@websplatter/core/load-worker, pass its address to setWorkerUrl, and let the Content-Security-Policy, if there ' +
      'is one, allow it (worker-src). The README of @websplatter/core says how, bundler by bundler, under “The worker”.',
  );
}
