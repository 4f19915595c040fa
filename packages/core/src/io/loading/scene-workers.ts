import { DestroyedError, fetched } from '../../data/errors.ts';
import type { SceneTasks } from '../formats/scene-tasks.ts';
import { Remote, RemotePool } from '../remote.ts';
import { hostedWorker, startWorker, workerStopped } from './start-worker.ts';

/** Most workers per scene: fetching and placing parts is the bottleneck beyond. */
const MOST_WORKERS = 6;

/**
 * Runs the tasks of a streamed scene in workers, up to the number of free cores. If no worker can
 * start, the calling thread runs the tasks.
 */
export class SceneWorkers extends RemotePool<SceneTasks> {
  readonly #sceneName: string;

  /** @param sceneName scene name in messages. */
  constructor(sceneName: string) {
    const find = async () => hostedWorker() ?? (await import('./workers.ts')).WORKERS.scenes;
    const cores = globalThis.navigator?.hardwareConcurrency ?? 1;
    super(
      Math.min(MOST_WORKERS, cores - 1),
      () =>
        // Without a worker, or code that starts it, the calling thread reads; errors of reading reach the call.
        new Remote((ending) => startWorker(find, ending).catch(() => null), {
          failure: (event) => workerStopped(sceneName, 'worker of the scene', event),
          here: async () => (await fetched('streaming', import('../formats/scene-tasks.ts'))).SCENE_TASKS,
        }),
    );
    this.#sceneName = sceneName;
  }

  /** Ends all workers. Pending and later calls reject with DestroyedError. */
  override end(): Promise<void> {
    return super.end(new DestroyedError(`The scene ${this.#sceneName}`, 'nothing shows it any more'));
  }
}
