import { checkedResult } from './brick-results.ts';
import type { BrickResult, BrickTask } from './brick-tasks.ts';

/** A task that was started. */
export interface StartedTask {
  /** Resolves once it is done, whether it failed or not. */
  readonly done: Promise<void>;
}

/** Has tasks done, some at once. */
export class WorkQueue {
  readonly #run: (task: BrickTask) => Promise<BrickResult>;
  /** One more than can be done: its data are there when it begins. */
  readonly #most: number;
  readonly #underWay = new Set<Promise<void>>();
  #failure: { readonly error: unknown } | undefined;

  /** @param threads tasks that `run` does at once. */
  constructor(run: (task: BrickTask) => Promise<BrickResult>, threads: number) {
    this.#run = run;
    this.#most = threads + 1;
  }

  /**
   * Starts a task once there is room. Resolves then; `use` is given its result later, before `done`
   * resolves.
   *
   * Rejects as the first task that failed, or `use`; with InvalidArgumentError 'run' for what is no
   * result of its task.
   */
  async start<Task extends BrickTask>(
    task: Task,
    use: (result: BrickResult<Task>) => Promise<void>,
  ): Promise<StartedTask> {
    while (this.#underWay.size >= this.#most) await Promise.race(this.#underWay);
    this.#throwFailure();
    const run = async () => use(checkedResult(task, await this.#run(task)));
    const work = run()
      .catch((error) => {
        this.#failure ??= { error };
      })
      .then(() => {
        this.#underWay.delete(work);
      });
    this.#underWay.add(work);
    return { done: work };
  }

  /** Resolves once these tasks are done; without any, once all are. Rejects as `start`. */
  async drain(tasks?: readonly StartedTask[]): Promise<void> {
    await (tasks ? Promise.all(tasks.map(({ done }) => done)) : this.end());
    this.#throwFailure();
  }

  /** Resolves once no task is under way. */
  async end(): Promise<void> {
    while (this.#underWay.size > 0) await Promise.all(this.#underWay);
  }

  #throwFailure(): void {
    if (this.#failure) throw this.#failure.error;
  }
}
