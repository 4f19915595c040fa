import { askWorker } from '../engine/ask-worker.ts';
import type { ExpectedImage, ExpectedRequest } from './expected.worker.ts';

/** Requests float64 images from a worker, one at a time; caches the last one. */
export class ExpectedImages {
  readonly #createWorker: () => Worker;
  #worker: Worker | null = null;
  #isBusy = false;
  #kept: { readonly key: string; readonly image: ExpectedImage } | null = null;

  /** @param createWorker for tests. */
  constructor(createWorker = startWorker) {
    this.#createWorker = createWorker;
  }

  /** Abandons the previous request, which may take long: its promise never settles. */
  async ask(request: ExpectedRequest): Promise<ExpectedImage> {
    const key = JSON.stringify(request);
    if (this.#isBusy) this.destroy();
    if (this.#kept?.key === key) return this.#kept.image;
    this.#isBusy = true;
    this.#worker ??= this.#createWorker();
    const image = await askWorker<ExpectedImage>(this.#worker, request).finally(() => {
      this.#isBusy = false;
    });
    this.#kept = { key, image };
    return image;
  }

  destroy(): void {
    this.#worker?.terminate();
    this.#worker = null;
    this.#isBusy = false;
  }
}

function startWorker(): Worker {
  return new Worker(new URL('./expected.worker.ts', import.meta.url), { type: 'module' });
}
