import type { Brick, BrickAddress } from '../../../data/bricks/brick.ts';
import { DestroyedError } from '../../../data/errors.ts';
import { Turns } from '../../../data/turns.ts';
import { hostedWorker } from '../../loading/hosted-worker.ts';
import { fromPostedError } from '../../loading/load-messages.ts';
import { startWorker, workerStopped } from '../../loading/start-worker.ts';
import { endWorker } from '../../loading/try-worker.ts';
import type { BrickFile } from './decode-brick.ts';
import type { BrickReply, BrickRequest } from './serve-bricks.ts';

/** Workers of a scene, at most: more decode faster than bricks are fetched and placed. */
const MOST_WORKERS = 4;
/** Longest that the calling thread is kept busy at a time: frames are drawn meanwhile. */
const MAX_BUSY_MS = 4;

/** A brick that is waited for. */
interface Wait {
  readonly resolve: (brick: Brick) => void;
  readonly reject: (reason: unknown) => void;
}

/**
 * Decodes the bricks of a scene in one worker, and in others where bricks would wait for it and
 * there are cores for them.
 */
export class BrickDecoders {
  readonly #all: BrickDecoder[];
  readonly #sceneName: string;
  readonly #most = Math.min(MOST_WORKERS, (globalThis.navigator?.hardwareConcurrency ?? 1) - 1);

  constructor(sceneName: string) {
    this.#sceneName = sceneName;
    this.#all = [new BrickDecoder(sceneName)];
  }

  /** The decoder of the next brick: that for which fewest wait. */
  next(): BrickDecoder {
    const least = this.#all.reduce((best, each) => (each.waiting < best.waiting ? each : best));
    if (least.waiting === 0 || this.#all.length >= this.#most) return least;
    const another = new BrickDecoder(this.#sceneName);
    this.#all.push(another);
    return another;
  }

  end(): void {
    for (const decoder of this.#all) decoder.end();
  }
}

/**
 * Decodes bricks of a scene: in a worker where one can start, else on the calling thread. The
 * worker starts at once, and ends with `end`.
 */
class BrickDecoder {
  readonly #ending = new AbortController();
  readonly #waits = new Map<number, Wait>();
  /** Null where none can start, and before it runs. */
  #worker: Worker | null = null;
  /** Settles when it is known whether a worker runs; null: the last one has died. */
  #starting: Promise<void> | null;
  readonly #sceneName: string;
  #lastId = 0;

  /** @param sceneName for messages. */
  constructor(sceneName: string) {
    this.#sceneName = sceneName;
    this.#starting = this.#start();
  }

  /** Bricks that it has not decoded yet. */
  get waiting(): number {
    return this.#waits.size;
  }

  /**
   * Decodes the brick at `address`.
   *
   * Rejects with SplatFileError 'damaged'; WebSplatterError 'worker-failed' if the worker dies, and
   * another one starts for the next brick; DestroyedError after `end`; the signal's reason.
   *
   * @param bytes all of the brick; they stay as they are.
   */
  async decode(
    bytes: Uint8Array<ArrayBuffer>,
    address: BrickAddress,
    file: BrickFile,
    signal?: AbortSignal,
  ): Promise<Brick> {
    this.#ending.signal.throwIfAborted();
    signal?.throwIfAborted();
    const id = ++this.#lastId;
    let onAbort = () => {};
    try {
      return await new Promise<Brick>((resolve, reject) => {
        this.#waits.set(id, { resolve, reject });
        onAbort = () => {
          this.#post({ brick: 'drop', id });
          reject(signal?.reason);
        };
        signal?.addEventListener('abort', onAbort, { once: true });
        this.#begin(id, bytes, address, file, signal).catch(reject);
      });
    } finally {
      signal?.removeEventListener('abort', onAbort);
      this.#waits.delete(id);
    }
  }

  /** Ends the worker, and rejects for all bricks that are waited for. */
  end(): void {
    this.#ending.abort(new DestroyedError(`The scene ${this.#sceneName}`, 'nothing shows it any more'));
    this.#worker = endWorker(this.#worker);
    this.#rejectAll(this.#ending.signal.reason);
  }

  async #begin(
    id: number,
    bytes: Uint8Array<ArrayBuffer>,
    address: BrickAddress,
    file: BrickFile,
    signal: AbortSignal | undefined,
  ): Promise<void> {
    this.#starting ??= this.#start();
    await this.#starting;
    const wait = this.#waits.get(id);
    if (!wait) return;
    if (this.#worker) {
      // They may be a part of more that is still needed.
      const own = bytes.slice();
      this.#post({ brick: 'decode', id, file, address, bytes: own }, [own.buffer]);
      return;
    }
    // Only pages without a worker for it fetch the code.
    const { readBrick } = await import('./decode-brick.ts');
    wait.resolve(await readBrick(bytes, address, file, new Turns(signal, MAX_BUSY_MS)));
  }

  /** Never rejects: without a worker, the calling thread decodes. */
  async #start(): Promise<void> {
    const { signal } = this.#ending;
    const find = async () => hostedWorker() ?? (await import('../../loading/workers.ts')).WORKERS.bricks;
    const worker = await startWorker(find, signal).catch(() => null);
    if (!worker || signal.aborted) {
      endWorker(worker);
      return;
    }
    this.#worker = worker;
    worker.onmessage = ({ data }: MessageEvent<BrickReply>) => {
      if (data.kind === 'brick') this.#waits.get(data.id)?.resolve(data.brick);
      else if (data.kind === 'error') this.#waits.get(data.id)?.reject(fromPostedError(data.error));
    };
    const fail = (event: Partial<ErrorEvent>) => {
      this.#worker = endWorker(worker);
      this.#starting = null;
      this.#rejectAll(workerStopped(this.#sceneName, 'worker that decodes bricks', event));
    };
    worker.onerror = fail;
    worker.onmessageerror = fail;
  }

  #post(request: BrickRequest, transfer: Transferable[] = []): void {
    this.#worker?.postMessage(request, transfer);
  }

  #rejectAll(reason: unknown): void {
    for (const { reject } of this.#waits.values()) reject(reason);
  }
}
