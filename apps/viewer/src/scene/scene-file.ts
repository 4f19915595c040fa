import { Remote } from '@websplatter/core/write';
import { workerFailure } from '@websplatter/kit/worker-failure';
import type { SceneWorkerTasks } from './scene.worker.ts';
import type { OnSaving, SaveRequest } from './write-scene.ts';

/** Runs tasks in a scene worker of their own, which ends with them. */
export async function inSceneWorker<Result>(
  run: (remote: Remote<SceneWorkerTasks>) => Promise<Result>,
): Promise<Result> {
  const remote = new Remote<SceneWorkerTasks>(
    () => new Worker(new URL('./scene.worker.ts', import.meta.url), { type: 'module' }),
    { failure: workerFailure },
  );
  try {
    return await run(remote);
  } finally {
    remote.end();
  }
}

/**
 * Has a worker write a scene as a file, until the signal aborts.
 *
 * @param onNote called with a sentence for each kind of data that the format cannot store.
 */
export function sceneFile(
  request: SaveRequest,
  onProgress: OnSaving,
  onNote: (note: string) => void,
  signal?: AbortSignal,
): Promise<Blob> {
  return inSceneWorker(async (remote) => {
    const { bytes, notes } = await remote.call('save', request, { signal, onProgress });
    for (const note of notes) onNote(note);
    return new Blob([bytes]);
  });
}
