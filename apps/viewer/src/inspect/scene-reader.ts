import { Remote } from '@websplatter/core/write';
import { workerFailure } from '@websplatter/kit/worker-failure';
import type { Answers, CloudToRead, Question, Topic } from '../scene/inspect-messages.ts';
import type { SceneWorkerTasks } from '../scene/scene.worker.ts';
import type { Reading } from '../state/inspecting.ts';

/**
 * Reads the scene's files again in a worker at the first question; keeps them until it is closed.
 */
export class SceneReader {
  readonly #clouds: () => Promise<readonly CloudToRead[]>;
  readonly #onReading: (reading: Reading) => void;
  #remote: Remote<SceneWorkerTasks> | null = null;
  /** Settles when the worker has read the files. */
  #reading: Promise<void> = Promise.resolve();

  /** @param clouds the files to read. */
  constructor(clouds: () => Promise<readonly CloudToRead[]>, onReading: (reading: Reading) => void) {
    this.#clouds = clouds;
    this.#onReading = onReading;
  }

  /**
   * Resolves with undefined if the scene cannot be read or the reader was closed.
   *
   * @param onProgress called with the fraction done, 0…1, where an answer takes long.
   */
  async ask<About extends Topic>(
    about: About,
    question: Answers[About]['question'],
    onProgress?: (part: number) => void,
  ): Promise<Answers[About]['answer'] | undefined> {
    this.#remote ??= this.#start();
    const remote = this.#remote;
    try {
      await this.#reading;
      return await remote.call('ask', { about, question } as Question, { onProgress });
    } catch (error) {
      if (this.#remote === remote) this.#fail(error as Error);
      return undefined;
    }
  }

  /** Frees the files; the next question reads them again. */
  close(): void {
    if (this.#remote) this.#end({ kind: 'none' });
  }

  #start(): Remote<SceneWorkerTasks> {
    const remote = new Remote<SceneWorkerTasks>(
      () => new Worker(new URL('../scene/scene.worker.ts', import.meta.url), { type: 'module' }),
      {
        failure: (event) => {
          const error = workerFailure(event);
          this.#fail(error);
          return error;
        },
      },
    );
    this.#reading = this.#read(remote);
    return remote;
  }

  async #read(remote: Remote<SceneWorkerTasks>): Promise<void> {
    this.#onReading({ kind: 'running', part: undefined });
    const onProgress = (part: number | undefined) => this.#onReading({ kind: 'running', part });
    await remote.call('read', await this.#clouds(), { onProgress });
    this.#onReading({ kind: 'done' });
  }

  #fail({ message }: Error): void {
    this.#end({ kind: 'failed', message });
  }

  #end(reading: Reading): void {
    this.#remote?.end();
    this.#remote = null;
    this.#onReading(reading);
  }
}
