import { type ColliderPort, serveCollider } from './collider/serve-collider.ts';
import { ALL_READERS } from './io/formats/readers.ts';
import { type LoadPort, serveLoad } from './io/loading/serve-load.ts';

// `@websplatter/core/load-worker`: does what the workers of all formats do, and makes colliders. It is built as one file
// without imports, for pages that host the worker themselves and name it to `setWorkerUrl`.

const port = self as unknown as LoadPort & ColliderPort;

port.onmessage = (event: MessageEvent) => {
  // Each takes the place of this listener: a worker reads files, or makes one collider.
  if ('kind' in event.data) serveLoad(port, ALL_READERS);
  else serveCollider(port);
  port.onmessage?.(event);
};
port.postMessage({ kind: 'ready' }, []);
