import { type PalettePort, servePalette } from './clouds/serve-palette.ts';
import { type ColliderPort, serveCollider } from './collider/serve-collider.ts';
import { ALL_READERS } from './io/formats/readers.ts';
import { type LoadPort, serveLoad } from './io/loading/serve-load.ts';

// `@websplatter/core/load-worker`: does what the workers of all formats do, finds palettes and makes colliders. It is built as one file without
// imports, for pages that host the worker themselves and name it to `setWorkerUrl`.

const port = self as unknown as LoadPort & PalettePort & ColliderPort;

port.onmessage = (event: MessageEvent) => {
  // Each takes the place of this listener: a worker reads files, or makes one collider, or finds one palette.
  if ('kind' in event.data) serveLoad(port, ALL_READERS);
  else if ('collider' in event.data) serveCollider(port);
  else servePalette(port);
  port.onmessage?.(event);
};
port.postMessage({ kind: 'ready' }, []);
