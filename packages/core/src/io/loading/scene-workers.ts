import { DestroyedError } from '../../data/errors.ts';
import { onAbort } from '../../data/on-abort.ts';
import { nextTask, SMOOTH_BUSY_MS, Turns } from '../../data/turns.ts';
import type { SceneTasks } from '../formats/scene-tasks.ts';
import { hostedWorker } from './hosted-worker.ts';
import { fromPostedError } from './load-messages.ts';
import type { SceneReply, SceneRequest, TaskInput, TaskResult } from './serve-scene.ts';
import { startWorker, workerStopped } from './start-worker.ts';
import { endWorker } from './try-worker.ts';

/** Workers of a scene, at most: more are faster than parts are fetched and placed. */
const MOST_WORKERS = 4;

type TaskName = keyof SceneTasks;
type AnyResult = TaskResult<TaskName>;

/** A task that is waited for. */
interface Wait {
  readonly resolve: (result: AnyResult) => void;
  readonly reject: (reason: unknown) => void;
}

/**
 * Does the tasks of a scene that streams: in one worker, and in others where tasks would wait for
 * it and there are cores for them; on the calling thread where none can start. The first worker
 * starts at once, and all end with `end`.
 */
export class SceneWorkers {
  readonly #all: SceneWorker[];
  readonly #sceneName: string;
  readonly #most = Math.min(MOST_WORKERS, (globalThis.navigator?.hardwareConcurrency ?? 1) - 1);

  /** @param sceneName for messages. */
  constructor(sceneName: string) {
    this.#sceneName = sceneName;
    this.#all = [new SceneWorker(sceneName)];
  }

  /**
   * Does a task. Rejects as the task does; with WebSplatterError 'worker-failed' if the worker dies,
   * and another one starts for the next task; with DestroyedError after `end`; with the signal's
   * reason.
   *
   * @param transfer what of the input goes to the worker, and is of no use afterwards.
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

  /** The worker of the next task: that for which fewest wait. */
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
  /** Null where none can start, and before it runs. */
  #worker: Worker | null = null;
  /** Settles when it is known whether a worker runs; null: the last one has died. */
  #starting: Promise<void> | null;
  readonly #sceneName: string;
  #lastId = 0;

  constructor(sceneName: string) {
    this.#sceneName = sceneName;
    this.#starting = this.#start();
  }

  /** Tasks that it has not done yet. */
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

  /** Ends the worker, and rejects for all tasks that are waited for. */
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
    // Only pages without a worker for it fetch the code.
    const { SCENE_TASKS } = await import('../formats/scene-tasks.ts');
    // Several that are due at once would keep the thread busy one after another.
    await nextTask();
    signal?.throwIfAborted();
    wait.resolve(await SCENE_TASKS[request.task](request.input as never, new Turns(signal, SMOOTH_BUSY_MS)));
  }

  /** Never rejects: without a worker, the calling thread does the tasks. */
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
