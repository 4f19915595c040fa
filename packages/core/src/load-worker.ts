import { COLLIDER_BUILDERS } from './clouds/collider/build-collider.ts';
import { builderTasks } from './clouds/geometry-builder.ts';
import { RAY_BUILDERS } from './clouds/rays/ray-tree-builder.ts';
import { FRAMING_BUILDERS } from './framing/framing-builder.ts';
import { ALL_READERS } from './io/formats/readers.ts';
import { SCENE_TASKS, WAITING_TASKS } from './io/formats/scene-tasks.ts';
import { type LoadPort, serveLoad, withPageDecoder } from './io/loading/serve-load.ts';
import { type ServerPort, serve } from './io/remote.ts';

// `@websplatter/core/load-worker`: the script of all workers. It is built as one file without
// imports, for pages that host the worker themselves and pass its URL to `setWorkerUrl`.

const TASKS = {
  ...SCENE_TASKS,
  ...builderTasks({ ...RAY_BUILDERS, ...COLLIDER_BUILDERS, ...FRAMING_BUILDERS }),
};

const port = self as unknown as LoadPort & ServerPort;

port.onmessage = (event: MessageEvent) => {
  // Each takes the place of this listener: a worker reads files or runs tasks.
  if ('kind' in event.data) serveLoad(port, withPageDecoder(port, ALL_READERS));
  else serve(TASKS, port, WAITING_TASKS);
  port.onmessage?.(event);
};
port.postMessage({ kind: 'ready' }, []);
