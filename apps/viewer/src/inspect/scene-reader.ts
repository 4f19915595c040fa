import { NOT_STARTED } from '@websplatter/kit/ask-worker';
import type { Answers, CloudToRead, InspectReply, InspectRequest, Topic } from '../scene/inspect-messages.ts';
import type { Reading } from '../state/inspecting.ts';

/**
 * Reads the scene's files again in a worker at the first question; keeps them until it is closed.
 */
export class SceneReader {
  readonly #clouds: () => Promise<readonly CloudToRead[]>;
  readonly #onReading: (reading: Reading) => void;
  readonly #waiting = new Map<number, (answer: Answers[Topic]['answer'] | undefined) => void>();
  #worker: Worker | null = null;
  /** Resolves when the worker has the list of files. */
  #whenTold: Promise<void> = Promise.resolve();
  #asked = 0;

  /** @param clouds the files to read. */
  constructor(clouds: () => Promise<readonly CloudToRead[]>, onReading: (reading: Reading) => void) {
    this.#clouds = clouds;
    this.#onReading = onReading;
  }

  /** Resolves with undefined if the scene cannot be read or the reader was closed. */
  async ask<About extends Topic>(
    about: About,
    question: Answers[About]['question'],
  ): Promise<Answers[About]['answer'] | undefined> {
    const id = ++this.#asked;
    this.#worker ??= this.#start();
    const worker = this.#worker;
    await this.#whenTold;
    if (this.#worker !== worker) return undefined;
    return new Promise((resolve) => {
      this.#waiting.set(id, resolve);
      worker.postMessage({ kind: 'ask', id, about, question } as InspectRequest);
    });
  }

  /** Frees the files; the next question reads them again. */
  close(): void {
    if (this.#worker) this.#end({ kind: 'none' });
  }

  #start(): Worker {
    const worker = new Worker(new URL('../scene/scene.worker.ts', import.meta.url), { type: 'module' });
    this.#onReading({ kind: 'running', part: undefined });
    this.#whenTold = this.#tell(worker);
    worker.onmessage = ({ data }: MessageEvent<InspectReply>) => this.#take(data);
    worker.onerror = ({ message }) => this.#end({ kind: 'failed', message: message || NOT_STARTED });
    return worker;
  }

  async #tell(worker: Worker): Promise<void> {
    try {
      const clouds = await this.#clouds();
      worker.postMessage({ kind: 'read', clouds } satisfies InspectRequest);
    } catch (error) {
      if (this.#worker === worker) this.#end({ kind: 'failed', message: (error as Error).message });
    }
  }

  #take(reply: InspectReply): void {
    switch (reply.kind) {
      case 'progress':
        this.#onReading({ kind: 'running', part: reply.part });
        return;
      case 'read':
        this.#onReading({ kind: 'done' });
        return;
      case 'failed':
        this.#end(reply);
        return;
      case 'answer':
        this.#waiting.get(reply.id)?.(reply.answer);
        this.#waiting.delete(reply.id);
    }
  }

  #end(reading: Reading): void {
    this.#worker?.terminate();
    this.#worker = null;
    for (const resolve of this.#waiting.values()) resolve(undefined);
    this.#waiting.clear();
    this.#onReading(reading);
  }
}
