import { COLLIDER_BUILDERS } from './clouds/collider/build-collider.ts';
import { type BuildPort, serveBuilder } from './clouds/geometry-builder.ts';
import { RAY_BUILDERS } from './clouds/ray-tree-builder.ts';
import { type BrickPort, serveBricks } from './io/formats/bricks/serve-bricks.ts';
import { ALL_READERS } from './io/formats/readers.ts';
import { type LoadPort, serveLoad } from './io/loading/serve-load.ts';

// `@websplatter/core/load-worker`: does what all workers do. It is built as one file without
// imports, for pages that host the worker themselves and name it to `setWorkerUrl`.

const port = self as unknown as LoadPort & BuildPort & BrickPort;

port.onmessage = (event: MessageEvent) => {
  // Each takes the place of this listener: a worker reads files, builds one thing, or decodes bricks.
  if ('kind' in event.data) serveLoad(port, ALL_READERS);
  else if ('brick' in event.data) serveBricks(port);
  else serveBuilder(port, { ...RAY_BUILDERS, ...COLLIDER_BUILDERS });
  port.onmessage?.(event);
};
port.postMessage({ kind: 'ready' }, []);
