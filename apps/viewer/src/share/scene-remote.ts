import { Remote } from '@websplatter/core/write';
import { workerFailure } from '@websplatter/kit/worker-failure';
import type { SceneWorkerTasks } from '../scene/scene.worker.ts';

/** Runs tasks in a scene worker of their own, which ends with them. */
export async function inSceneWorker<Result>(
  run: (remote: Remote<SceneWorkerTasks>) => Promise<Result>,
): Promise<Result> {
  const remote = new Remote<SceneWorkerTasks>(
    () => new Worker(new URL('../scene/scene.worker.ts', import.meta.url), { type: 'module' }),
    { failure: workerFailure },
  );
  try {
    return await run(remote);
  } finally {
    remote.end();
  }
}
