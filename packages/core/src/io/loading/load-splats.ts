import { fetched } from '../../data/errors.ts';
import { guarded } from '../../data/listeners.ts';
import { onAbort } from '../../data/on-abort.ts';
import type { PackedCloud } from '../../data/packing/packed-cloud.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import type { Passed, RowsTo } from '../formats/rows/row-sink.ts';
import { fromPostedError } from '../posted-error.ts';
import { bytesOf, isBlob, type KnownSource, knownSource } from '../sources/known-source.ts';
import type { ReadOptions, ReadSplatsOptions, SplatSource } from '../sources/splat-source.ts';
import type { LoadReply, LoadRequest, LoadSettings } from './serve-load.ts';
import { endWorker, hostedWorker, startWorker, workerStopped } from './start-worker.ts';
import { endTurn, takeTurn } from './worker-turns.ts';
import type { WORKERS } from './workers.ts';

/** Options of `loadSplats`. */
export interface LoadSplatsOptions extends ReadSplatsOptions {
  /** Storage precision of positions, rotations and scales. Default: `packed`. */
  readonly geometryPrecision?: GeometryPrecision;
}

type PostedPiece = Extract<LoadReply, { kind: 'rows' }>;
/** Reply of the PLY worker for a file of another format. */
type OtherFile = Extract<LoadReply, { kind: 'other-format' }>;

/** Kind of a worker that reads files. */
type Kind = Exclude<keyof typeof WORKERS, 'scenes'>;

type Watch = Pick<ReadOptions, 'signal' | 'onProgress'>;

/**
 * Reads splats and packs them for the GPU in a worker. If no worker can start, the calling thread
 * does the work. This is so in Node, and in pages whose bundler or content security policy prevents
 * workers, which the console reports once; see `setWorkerUrl`.
 *
 * Buffers are copied to the worker, so the caller's stay usable; a stream is consumed. Parallel
 * loads are limited to the number of hardware threads, clamped to 2 to 8; further loads are queued.
 *
 * Rejects as `readSplats` does; with `WebSplatterError` 'worker-failed' if the worker dies, usually
 * from lack of memory; and with the signal's reason. An abort stops the worker at once.
 *
 * @example
 * const packed = await loadSplats('/garden.ply', { signal: AbortSignal.timeout(60_000) });
 * const cloud = engine.addPacked(packed);
 */
export async function loadSplats(source: SplatSource, options: LoadSplatsOptions = {}): Promise<PackedCloud> {
  // Without a sink, the result is always a cloud.
  return (await loadOrPass(knownSource(source, options), options, undefined)) as PackedCloud;
}

/** As `loadSplats`; `passed` if the file's raw rows went to `rowsTo`. */
export async function loadOrPass(
  source: KnownSource,
  options: LoadSplatsOptions,
  rowsTo: RowsTo | undefined,
): Promise<PackedCloud | Passed> {
  const { shPrecision = 'u8', geometryPrecision = 'packed', signal } = options;
  const { name, format, maxBytes, maxSplats, request } = options;
  const onProgress = guarded(options.onProgress);
  signal?.throwIfAborted();
  // The workers of its file read it.
  if (source.kind === 'frame') return source.frame.loadFrame({ geometryPrecision, shPrecision }, signal);
  const settings: LoadSettings = {
    ...{ name, format, maxBytes, maxSplats, request },
    ...{ shPrecision, geometryPrecision },
  };
  let worker = await takeTurn(signal);
  let kind: Kind = source.kind === 'files' || isNamedOtherwise(source, format) ? 'others' : 'ply';
  let isDone = false;
  // Always aborted at the end: a terminated worker does not cancel its stream.
  const stop = new AbortController();
  const ignoreSignal = onAbort(signal, () => stop.abort(signal?.reason));
  const watch = {
    signal: stop.signal,
    onProgress,
    onDone: () => {
      isDone = true;
    },
  };
  try {
    signal?.throwIfAborted();
    let from: KnownSource = source;
    // A single file needs no other.
    if (source.kind === 'files' && source.files.length === 1 && isBlob(source.files[0]))
      from = knownSource(source.files[0], options);
    // The spare worker can read PLY only.
    if (kind === 'others') worker = endWorker(worker);
    for (;;) {
      const wanted = kind;
      worker ??= await startWorker(() => makerOf(wanted), signal);
      if (worker === null) return await readHere(from, settings, { signal, onProgress }, rowsTo);
      const result = await loadInWorker(worker, from, settings, watch, rowsTo);
      if (result === 'passed' || !('kind' in result)) return result;
      worker = endWorker(worker);
      if (result.stream) from = { ...from, kind: 'stream', stream: result.stream };
      kind = 'others';
    }
  } finally {
    ignoreSignal();
    // Most loads are PLY, so only PLY workers are kept for the next load.
    if (!isDone || kind !== 'ply') worker = endWorker(worker);
    endTurn(worker);
    stop.abort();
  }
}

/**
 * Whether the source's own name, or the caller's if that has no extension, indicates another format
 * than PLY.
 */
function isNamedOtherwise({ fileNames }: KnownSource, format: string | undefined): boolean {
  // The PLY worker does not check formats.
  if (format !== undefined) return format !== 'ply';
  const fileName = fileNames.findLast((name) => name.includes('.')) ?? '';
  return /\.compressed\.ply$|\.(?!ply$)[\w-]+$/i.test(fileName);
}

/** Reads in the calling thread. The code is fetched only if no worker can read. */
async function readHere(
  source: KnownSource,
  settings: LoadSettings,
  watch: Watch,
  rowsTo: RowsTo | undefined,
): Promise<PackedCloud | Passed> {
  const [{ readAndPack }, { THREAD_READERS }] = await fetched(
    'loading',
    Promise.all([import('./serve-load.ts'), import('../formats/thread-readers.ts')]),
  );
  return readAndPack(source, settings, watch, THREAD_READERS, rowsTo);
}

const loadWorkers = () => import('./workers.ts');

/** Prefetches the code that starts workers. */
export function foreseeWorkers(): void {
  // A later load reports the error.
  loadWorkers().catch(() => {});
}

async function makerOf(kind: Kind): Promise<() => Worker> {
  return hostedWorker() ?? (await fetched('loading', loadWorkers())).WORKERS[kind];
}

/**
 * Runs a load in a worker. Settles at the latest when `watch.signal` aborts, which also cancels a
 * stream. Calls `watch.onDone` when the worker is free for another load.
 */
function loadInWorker(
  worker: Worker,
  source: KnownSource,
  settings: LoadSettings,
  watch: Watch & { readonly signal: AbortSignal; readonly onDone: () => void },
  rowsTo: RowsTo | undefined,
): Promise<PackedCloud | Passed | OtherFile> {
  /** Settles when all rows so far have been taken. */
  let taken: Promise<void> = Promise.resolve();
  const takeRows = async ({ memory, rowCount }: PostedPiece) => {
    const { sink } = rowsTo!;
    const own = await sink.memory();
    own.set(new Uint8Array(memory));
    sink.take(rowCount, own);
    worker.postMessage({ kind: 'memory', memory } satisfies LoadRequest, [memory]);
  };
  watch.signal.throwIfAborted();
  return new Promise((resolve, reject) => {
    watch.signal.addEventListener('abort', () => reject(watch.signal.reason), { once: true });
    const fail = (event: Partial<ErrorEvent>) => reject(workerStopped(source.name, 'loading worker', event));
    const finish = (cloud: PackedCloud | Passed) => {
      watch.onDone();
      resolve(cloud);
    };
    worker.onerror = fail;
    worker.onmessageerror = fail;
    worker.onmessage = ({ data }: MessageEvent<LoadReply>) => {
      const then = (next: () => Promise<void> | void) => {
        taken = taken.then(next);
        taken.catch(reject);
      };
      if (data.kind === 'cloud') finish(data.cloud);
      else if (data.kind === 'layout') then(() => rowsTo!.sink.begin(data.layout));
      else if (data.kind === 'rows') then(() => takeRows(data));
      else if (data.kind === 'rows-note') then(() => rowsTo!.sink.note?.(data.text));
      else if (data.kind === 'rows-end') then(() => finish('passed'));
      else if (data.kind === 'packed-view') answerView(data).catch(reject);
      else if (data.kind === 'other-format') resolve(data);
      else if (data.kind === 'error') reject(fromPostedError(data.error));
      else if (data.kind === 'progress') watch.onProgress?.(data.progress);
    };
    const unposted = post(worker, source, settings, rowsTo, watch.signal);
    if (unposted) resolve(readHere(unposted, settings, watch, rowsTo));
  });
}

/** Few files need the decoder, so its code is fetched on first use. */
async function answerView(packed: Extract<LoadReply, { kind: 'packed-view' }>): Promise<void> {
  const { answerPackedView } = await fetched('loading', import('./meshopt-on-page.ts'));
  await answerPackedView(packed);
}

/** Posts the job. If it cannot be posted, returns the source, to be read in this thread. */
function post(
  worker: Worker,
  source: KnownSource,
  settings: LoadSettings,
  rowsTo: RowsTo | undefined,
  signal: AbortSignal,
): KnownSource | undefined {
  let posted = source;
  let transfer: Transferable[] = [];
  if (source.kind === 'stream') {
    // The reader rejects locked streams with a proper error.
    if (source.stream.locked) return source;
    // An intermediate pipe, because a posted stream can no longer be cancelled from here.
    const stream = source.stream.pipeThrough(new TransformStream<Uint8Array, Uint8Array>(), { signal });
    posted = { ...source, stream };
    transfer = [stream];
  } else if (source.kind === 'bytes') {
    const bytes = bytesOf(source.bytes).slice();
    posted = { ...source, bytes };
    transfer = [bytes.buffer];
  }
  try {
    const request: LoadRequest = { kind: 'load', source: posted, settings, rows: rowsTo?.files ?? null };
    worker.postMessage(request, transfer);
    return undefined;
  } catch (error) {
    // Safari cannot transfer streams, and Headers cannot be cloned. The source is still unused.
    if (error instanceof DOMException && error.name === 'DataCloneError') return posted;
    throw error;
  }
}
