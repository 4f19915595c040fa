import { type PalettePort, servePalette } from './clouds/serve-palette.ts';
import { ALL_READERS } from './io/formats/readers.ts';
import { type LoadPort, serveLoad } from './io/loading/serve-load.ts';

// `@websplatter/core/load-worker`: does what the workers of all formats do, and finds palettes. It is built as one file without
// imports, for pages that host the worker themselves and name it to `setWorkerUrl`.

const port = self as unknown as LoadPort & PalettePort;

port.onmessage = (event: MessageEvent) => {
  // Either takes the place of this listener: a worker reads files, or finds one palette.
  if ('kind' in event.data) serveLoad(port, ALL_READERS);
  else servePalette(port);
  port.onmessage?.(event);
};
port.postMessage({ kind: 'ready' }, []);
