import { DestroyedError } from '../../data/errors.ts';
import { onAbort } from '../../data/on-abort.ts';
import { nextTask, SMOOTH_BUSY_MS, Turns } from '../../data/turns.ts';
import type { SceneTasks } from '../formats/scene-tasks.ts';
import { fromPostedError } from '../posted-error.ts';
import { hostedWorker } from './hosted-worker.ts';
import type { SceneReply, SceneRequest, TaskInput, TaskResult } from './serve-scene.ts';
import { startWorker, workerStopped } from './start-worker.ts';
import { endWorker } from './try-worker.ts';

/** Most workers per scene: fetching and placing parts is the bottleneck beyond. */
const MOST_WORKERS = 4;

type TaskName = keyof SceneTasks;
type AnyResult = TaskResult<TaskName>;

/** A pending task. */
interface Wait {
  readonly resolve: (result: AnyResult) => void;
  readonly reject: (reason: unknown) => void;
}

/**
 * Runs the tasks of a streamed scene in workers. The first worker starts at once; further ones
 * start if tasks would wait and cores are free. If no worker can start, the calling thread runs the
 * tasks. All workers end with `end`.
 */
export class SceneWorkers {
  readonly #all: SceneWorker[];
  readonly #sceneName: string;
  readonly #most = Math.min(MOST_WORKERS, (globalThis.navigator?.hardwareConcurrency ?? 1) - 1);

  /** @param sceneName scene name in messages. */
  constructor(sceneName: string) {
    this.#sceneName = sceneName;
    this.#all = [new SceneWorker(sceneName)];
  }

  /**
   * Runs a task. Rejects as the task does, with DestroyedError after `end`, and with the signal's
   * reason. If the worker dies, rejects with WebSplatterError 'worker-failed'; the next task starts
   * another worker.
   *
   * @param transfer objects of the input to transfer to the worker; they are unusable afterwards.
   */
  run<Name extends TaskName>(
    task: Name,
    input: TaskInput<Name>,
    transfer: Transferable[],
    signal?: AbortSignal,
  ): Promise<TaskResult<Name>> {
    return this.#next().run(task, input, transfer, signal) as Promise<TaskResult<Name>>;
  }

  end(): void {
    for (const worker of this.#all) worker.end();
  }

  /** The worker with the fewest pending tasks. */
  #next(): SceneWorker {
    const least = this.#all.reduce((best, each) => (each.waiting < best.waiting ? each : best));
    if (least.waiting === 0 || this.#all.length >= this.#most) return least;
    const another = new SceneWorker(this.#sceneName);
    this.#all.push(another);
    return another;
  }
}

class SceneWorker {
  readonly #ending = new AbortController();
  readonly #waits = new Map<number, Wait>();
  /** Null before it runs, and if none can start. */
  #worker: Worker | null = null;
  /** Settles once the start of the worker has succeeded or failed; null after the last worker died. */
  #starting: Promise<void> | null;
  readonly #sceneName: string;
  #lastId = 0;

  constructor(sceneName: string) {
    this.#sceneName = sceneName;
    this.#starting = this.#start();
  }

  /** Number of pending tasks. */
  get waiting(): number {
    return this.#waits.size;
  }

  async run(
    task: TaskName,
    input: TaskInput<TaskName>,
    transfer: Transferable[],
    signal?: AbortSignal,
  ): Promise<AnyResult> {
    this.#ending.signal.throwIfAborted();
    signal?.throwIfAborted();
    const id = ++this.#lastId;
    let ignoreSignal = () => {};
    try {
      return await new Promise<AnyResult>((resolve, reject) => {
        this.#waits.set(id, { resolve, reject });
        ignoreSignal = onAbort(signal, () => {
          this.#post({ task: 'drop', id });
          reject(signal?.reason);
        });
        this.#begin({ task, id, input }, transfer, signal).catch(reject);
      });
    } finally {
      ignoreSignal();
      this.#waits.delete(id);
    }
  }

  /** Terminates the worker and rejects all pending tasks. */
  end(): void {
    this.#ending.abort(new DestroyedError(`The scene ${this.#sceneName}`, 'nothing shows it any more'));
    this.#worker = endWorker(this.#worker);
    this.#rejectAll(this.#ending.signal.reason);
  }

  async #begin(
    request: Exclude<SceneRequest, { task: 'drop' }>,
    transfer: Transferable[],
    signal: AbortSignal | undefined,
  ): Promise<void> {
    this.#starting ??= this.#start();
    await this.#starting;
    const wait = this.#waits.get(request.id);
    if (!wait) return;
    if (this.#worker) {
      this.#post(request, transfer);
      return;
    }
    // Fetched only if no worker can start.
    const { SCENE_TASKS } = await import('../formats/scene-tasks.ts');
    // Yields first, so that several pending tasks do not block the thread.
    await nextTask();
    signal?.throwIfAborted();
    wait.resolve(await SCENE_TASKS[request.task](request.input as never, new Turns(signal, SMOOTH_BUSY_MS)));
  }

  /** Never rejects: without a worker, the calling thread runs the tasks. */
  async #start(): Promise<void> {
    const { signal } = this.#ending;
    const find = async () => hostedWorker() ?? (await import('./workers.ts')).WORKERS.scenes;
    const worker = await startWorker(find, signal).catch(() => null);
    if (!worker || signal.aborted) {
      endWorker(worker);
      return;
    }
    this.#worker = worker;
    worker.onmessage = ({ data }: MessageEvent<SceneReply>) => {
      if (data.kind === 'done') this.#waits.get(data.id)?.resolve(data.result);
      else if (data.kind === 'error') this.#waits.get(data.id)?.reject(fromPostedError(data.error));
    };
    const fail = (event: Partial<ErrorEvent>) => {
      this.#worker = endWorker(worker);
      this.#starting = null;
      this.#rejectAll(workerStopped(this.#sceneName, 'worker of the scene', event));
    };
    worker.onerror = fail;
    worker.onmessageerror = fail;
  }

  #post(request: SceneRequest, transfer: Transferable[] = []): void {
    this.#worker?.postMessage(request, transfer);
  }

  #rejectAll(reason: unknown): void {
    for (const { reject } of this.#waits.values()) reject(reason);
  }
}
