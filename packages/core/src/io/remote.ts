import { onAbort } from '../data/on-abort.ts';
import { nextTask, SMOOTH_BUSY_MS, Turns } from '../data/turns.ts';
import { fromPostedError, type PostedError, toPostedError } from './posted-error.ts';

// Tasks for other threads: `serve` runs them in one thread, `Remote` calls them from another.

/**
 * A task that another thread can call. Input, progress and result are posted. The memory of progress
 * and result is transferred, so the task must not keep it. `turns` reject once the caller aborts.
 */
type Task = (input: never, turns: Turns, onProgress: (progress: unknown) => void) => unknown;

export type Tasks = Readonly<Record<string, Task>>;

interface TaskRequest {
  readonly task: string;
  /** Id of the call; its replies have the same. */
  readonly id: number;
  readonly input: unknown;
}

/** Caller to server. */
export type RemoteRequest =
  | TaskRequest
  /** Aborts the call with this id. */
  | { readonly drop: number };

/** Server to caller. */
export type RemoteReply =
  /** The thread's script is running. */
  | { readonly kind: 'ready' }
  | { readonly kind: 'progress'; readonly id: number; readonly progress: unknown }
  | { readonly kind: 'done'; readonly id: number; readonly result: unknown }
  | { readonly kind: 'error'; readonly id: number; readonly error: PostedError };

/** The used part of a worker's global scope; a MessagePort has it too. */
export interface ServerPort {
  onmessage: ((event: MessageEvent<RemoteRequest>) => void) | null;
  postMessage(reply: RemoteReply, transfer: Transferable[]): void;
}

/**
 * Runs the tasks that the other side of a port calls, one after another.
 *
 * @param port default: the global scope of this worker.
 * @param besides names of tasks that run beside others at once, because they mostly wait.
 */
export function serve(
  tasks: Tasks,
  port: ServerPort = self as unknown as ServerPort,
  besides: readonly string[] = [],
): void {
  /** Abort controllers of pending calls, by id. */
  const endings = new Map<number, AbortController>();
  let last: Promise<void> = Promise.resolve();
  const run = async ({ task, id, input }: TaskRequest, signal: AbortSignal) => {
    const onProgress = (progress: unknown) =>
      port.postMessage({ kind: 'progress', id, progress }, [...buffersIn(progress)]);
    try {
      signal.throwIfAborted();
      const result = await tasks[task](input as never, new Turns(signal), onProgress);
      port.postMessage({ kind: 'done', id, result }, [...buffersIn(result)]);
    } catch (error) {
      port.postMessage({ kind: 'error', id, error: toPostedError(error) }, []);
    } finally {
      endings.delete(id);
    }
  };
  port.onmessage = ({ data: request }) => {
    if ('drop' in request) {
      endings.get(request.drop)?.abort();
      return;
    }
    const ending = new AbortController();
    endings.set(request.id, ending);
    if (besides.includes(request.task)) void run(request, ending.signal);
    else last = last.then(() => run(request, ending.signal));
  };
  port.postMessage({ kind: 'ready' }, []);
}

/** Buffers of all typed arrays in plain data, for a transfer list. */
export function buffersIn(value: unknown, found = new Set<ArrayBuffer>()): Set<ArrayBuffer> {
  if (ArrayBuffer.isView(value)) found.add(value.buffer as ArrayBuffer);
  else if (value instanceof Object) for (const each of Object.values(value)) buffersIn(each, found);
  return found;
}

/** The used part of a worker; a MessagePort has it too. */
interface CallerPort {
  onmessage: ((event: MessageEvent<RemoteReply>) => void) | null;
  onmessageerror: ((event: MessageEvent) => void) | null;
  onerror?: ((event: ErrorEvent) => void) | null;
  postMessage(request: RemoteRequest, transfer: Transferable[]): void;
  terminate?(): unknown;
}

/** Starts a thread; resolves with null if none can start. `ending` aborts with `Remote.end`. */
type StartThread = (ending: AbortSignal) => Promise<CallerPort | null> | CallerPort;

interface RemoteOptions<Served extends Tasks> {
  /** Makes the error for a thread that died. */
  readonly failure: (event: Partial<ErrorEvent>) => Error;
  /** Fetches the tasks, to run them in the calling thread if no other thread can start. */
  readonly here?: () => Promise<Served>;
}

interface CallOptions<Served extends Tasks, Name extends keyof Served> {
  readonly signal?: AbortSignal;
  readonly onProgress?: Parameters<Served[Name]>[2];
  readonly transfer?: Transferable[];
}

interface Call {
  readonly resolve: (result: never) => void;
  readonly reject: (reason: unknown) => void;
  readonly onProgress?: (progress: never) => void;
}

/**
 * Calls the tasks of another thread, which it starts at once.
 *
 * @hidden Only this repository uses it, and API pages do not list it.
 */
export class Remote<Served extends Tasks> {
  readonly #here: RemoteOptions<Served>['here'];
  readonly #ending = new AbortController();
  readonly #calls = new Map<number, Call>();
  readonly #starting: Promise<void>;
  /** Null before the thread runs, and if none can start. */
  #port: CallerPort | null = null;
  #lastId = 0;

  constructor(start: StartThread, { failure, here }: RemoteOptions<Served>) {
    this.#here = here;
    this.#starting = this.#start(start, failure);
    // Calls reject with the error.
    this.#starting.catch(() => {});
  }

  /** Number of pending calls. */
  get waiting(): number {
    return this.#calls.size;
  }

  /** Whether `end` was called, or the thread died. */
  get hasEnded(): boolean {
    return this.#ending.signal.aborted;
  }

  /**
   * Runs a task and resolves with its result. Rejects with the error of the task, with the error of
   * `failure` if the thread dies or has died, and with the reason of `end` and of the signal.
   *
   * @param options.transfer objects of the input to transfer; they are unusable afterwards.
   */
  async call<Name extends string & keyof Served>(
    task: Name,
    input: Parameters<Served[Name]>[0],
    options: CallOptions<Served, Name> = {},
  ): Promise<Awaited<ReturnType<Served[Name]>>> {
    const { signal, onProgress, transfer = [] } = options;
    this.#ending.signal.throwIfAborted();
    signal?.throwIfAborted();
    const id = ++this.#lastId;
    let ignoreSignal = () => {};
    try {
      return await new Promise((resolve, reject) => {
        this.#calls.set(id, { resolve, reject, onProgress });
        ignoreSignal = onAbort(signal, () => {
          this.#port?.postMessage({ drop: id }, []);
          reject(signal?.reason);
        });
        this.#begin({ task, id, input }, transfer, signal).catch(reject);
      });
    } finally {
      ignoreSignal();
      this.#calls.delete(id);
    }
  }

  /** Ends the thread. Pending and later calls reject with `reason`. */
  async end(reason?: unknown): Promise<void> {
    this.#ending.abort(reason);
    for (const { reject } of this.#calls.values()) reject(this.#ending.signal.reason);
    await this.#port?.terminate?.();
  }

  async #start(start: StartThread, failure: RemoteOptions<Served>['failure']): Promise<void> {
    const port = await start(this.#ending.signal);
    if (!port || this.hasEnded) {
      port?.terminate?.();
      return;
    }
    this.#port = port;
    port.onmessage = ({ data }) => {
      if (data.kind === 'ready') return;
      const call = this.#calls.get(data.id);
      if (data.kind === 'done') call?.resolve(data.result as never);
      else if (data.kind === 'error') call?.reject(fromPostedError(data.error));
      else call?.onProgress?.(data.progress as never);
    };
    const fail = (event: Partial<ErrorEvent>) => this.end(failure(event));
    port.onerror = fail;
    port.onmessageerror = fail;
  }

  async #begin(request: TaskRequest, transfer: Transferable[], signal?: AbortSignal): Promise<void> {
    await this.#starting;
    const call = this.#calls.get(request.id);
    if (!call || signal?.aborted) return;
    if (this.#port) {
      this.#port.postMessage(request, transfer);
      return;
    }
    const tasks = await this.#here!();
    // Yields first, so that several pending calls do not block the thread.
    await nextTask();
    if (!this.#calls.has(request.id)) return;
    const turns = new Turns(signal, SMOOTH_BUSY_MS);
    const onProgress = (progress: unknown) => call.onProgress?.(progress as never);
    call.resolve((await tasks[request.task](request.input as never, turns, onProgress)) as never);
  }
}

/** Calls of a key that wait in one thread before another one is asked, too. */
const MOST_WAITING = 4;

function leastBusy<Served extends Tasks>(remotes: readonly Remote<Served>[]): Remote<Served> | undefined {
  return remotes.toSorted((a, b) => a.waiting - b.waiting)[0];
}

/**
 * Spreads calls over threads. The first thread starts at once. Another one starts if a call would
 * wait, or if all have died.
 *
 * @hidden See `Remote`.
 */
export class RemotePool<Served extends Tasks> {
  readonly #most: number;
  readonly #make: () => Remote<Served>;
  #all: Remote<Served>[] = [];
  /** Keys of the calls that a thread has had. */
  readonly #keys = new WeakMap<Remote<Served>, Set<number>>();
  #ended: { readonly reason: unknown } | null = null;

  /** @param most threads at once. */
  constructor(most: number, make: () => Remote<Served>) {
    this.#most = most;
    this.#make = make;
    this.#start();
  }

  /**
   * See `Remote.call`.
   *
   * @param options.key calls of one key go to a thread that has had it before and may have kept
   *   results, unless many wait there while another thread has none.
   */
  call<Name extends string & keyof Served>(
    task: Name,
    input: Parameters<Served[Name]>[0],
    { key, ...options }: CallOptions<Served, Name> & { readonly key?: number } = {},
  ): Promise<Awaited<ReturnType<Served[Name]>>> {
    return this.#ended ? Promise.reject(this.#ended.reason) : this.#next(key).call(task, input, options);
  }

  /** Ends all threads. Pending and later calls reject with `reason`. */
  async end(reason?: unknown): Promise<void> {
    this.#ended ??= { reason };
    await Promise.all(this.#all.map((remote) => remote.end(reason)));
  }

  /** The thread of a key, or the one with the fewest pending calls. */
  #next(key?: number): Remote<Served> {
    this.#all = this.#all.filter(({ hasEnded }) => !hasEnded);
    const ofKey = leastBusy(
      this.#all.filter((remote) => key !== undefined && this.#keys.get(remote)!.has(key)),
    );
    const least = leastBusy(this.#all);
    const isFree = least && (least.waiting === 0 || this.#all.length >= this.#most);
    if (ofKey && (ofKey.waiting < MOST_WAITING || (isFree && least.waiting > 0))) return ofKey;
    const next = isFree ? least : this.#start();
    // Of several without calls, the next call of another key goes to the one that is idle for longest.
    this.#all = [...this.#all.filter((remote) => remote !== next), next];
    if (key !== undefined) this.#keys.get(next)!.add(key);
    return next;
  }

  /** Starts all threads now, for work that will come at once and soon. */
  startAll(): void {
    while (this.#all.length < this.#most) this.#start();
  }

  #start(): Remote<Served> {
    const remote = this.#make();
    this.#keys.set(remote, new Set());
    this.#all.push(remote);
    return remote;
  }
}
