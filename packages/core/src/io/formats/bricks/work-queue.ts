import { checkedResult } from './brick-results.ts';
import type { BrickResult, BrickTask } from './brick-tasks.ts';

export interface StartedTask {
  /** Resolves when the task has finished or failed. */
  readonly done: Promise<void>;
}

/** Runs tasks, some in parallel. */
export class WorkQueue {
  readonly #run: (task: BrickTask) => Promise<BrickResult>;
  /** One more than `threads`, so that the next task's data are ready when a thread is free. */
  readonly #most: number;
  readonly #underWay = new Set<Promise<void>>();
  #failure: { readonly error: unknown } | undefined;

  /** @param threads number of tasks that `run` can process in parallel. */
  constructor(run: (task: BrickTask) => Promise<BrickResult>, threads: number) {
    this.#run = run;
    this.#most = threads + 1;
  }

  /**
   * Starts a task once a slot is free, then resolves. `use` gets the result later, before `done`
   * resolves.
   *
   * Rejects as the first task that failed, or as `use`; with InvalidArgumentError 'run' if a result
   * does not fit its task.
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

  /** Resolves once these tasks are done; without an argument, once all are. Rejects as `start`. */
  async drain(tasks?: readonly StartedTask[]): Promise<void> {
    await (tasks ? Promise.all(tasks.map(({ done }) => done)) : this.end());
    this.#throwFailure();
  }

  /** Resolves once no task is running. */
  async end(): Promise<void> {
    while (this.#underWay.size > 0) await Promise.all(this.#underWay);
  }

  #throwFailure(): void {
    if (this.#failure) throw this.#failure.error;
  }
}
