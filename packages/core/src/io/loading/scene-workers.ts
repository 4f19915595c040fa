import { DestroyedError } from '../../data/errors.ts';
import type { SceneTasks } from '../formats/scene-tasks.ts';
import { Remote } from '../remote.ts';
import { hostedWorker } from './hosted-worker.ts';
import { startWorker, workerStopped } from './start-worker.ts';

/** Most workers per scene: fetching and placing parts is the bottleneck beyond. */
const MOST_WORKERS = 4;

/**
 * Runs the tasks of a streamed scene in workers. The first worker starts at once; further ones
 * start if tasks would wait and cores are free. If no worker can start, the calling thread runs the
 * tasks. All workers end with `end`.
 */
export class SceneWorkers {
  readonly #sceneName: string;
  readonly #most = Math.min(MOST_WORKERS, (globalThis.navigator?.hardwareConcurrency ?? 1) - 1);
  #all: Remote<SceneTasks>[] = [];
  #ended: DestroyedError | null = null;

  /** @param sceneName scene name in messages. */
  constructor(sceneName: string) {
    this.#sceneName = sceneName;
    this.#start();
  }

  /**
   * Runs a task. Rejects as `Remote.call`: with DestroyedError after `end`, and with
   * WebSplatterError 'worker-failed' if the worker dies; the next task starts another worker.
   */
  readonly call: Remote<SceneTasks>['call'] = (task, input, options) =>
    this.#ended ? Promise.reject(this.#ended) : this.#next().call(task, input, options);

  end(): void {
    this.#ended ??= new DestroyedError(`The scene ${this.#sceneName}`, 'nothing shows it any more');
    for (const worker of this.#all) worker.end(this.#ended);
  }

  /** The worker with the fewest pending tasks. */
  #next(): Remote<SceneTasks> {
    this.#all = this.#all.filter(({ hasEnded }) => !hasEnded);
    const [least] = this.#all.toSorted((a, b) => a.waiting - b.waiting);
    return least && (least.waiting === 0 || this.#all.length >= this.#most) ? least : this.#start();
  }

  #start(): Remote<SceneTasks> {
    const find = async () => hostedWorker() ?? (await import('./workers.ts')).WORKERS.scenes;
    const worker = new Remote<SceneTasks>((ending) => startWorker(find, ending).catch(() => null), {
      failure: (event) => workerStopped(this.#sceneName, 'worker of the scene', event),
      here: async () => (await import('../formats/scene-tasks.ts')).SCENE_TASKS,
    });
    this.#all.push(worker);
    return worker;
  }
}
