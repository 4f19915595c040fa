import { fetched, WebSplatterError } from '../../data/errors.ts';
import { given } from '../../data/given.ts';
import { callListener } from '../../data/listeners.ts';
import { startWorker, workerStopped } from '../loading/start-worker.ts';
import { Remote } from '../remote.ts';
import { shortName } from '../sources/known-source.ts';
import { findBricks, lockName, StorageRoomError } from './kept-scenes.ts';
import type { KEEP_TASKS } from './serve-keep.ts';

/** Options of `keepBricks`. */
export interface KeepOptions {
  /**
   * Before the promise resolves: aborts the work, which a later call resumes. Afterwards: releases
   * the scene, which is protected from removal until then or until the page ends.
   */
  readonly signal?: AbortSignal;
  /** Called with the fraction of the work that is done, from 0 to 1. */
  readonly onProgress?: (fraction: number) => void;
}

/** Most helper workers; each takes about 140 MB. */
const MOST_HELPERS = 4;
/** Threads left for the page and the browser. */
const OTHER_THREADS = 2;

/**
 * Returns the stored bricks that `keepBricks` made from this file, for `engine.load`; null if there
 * are none. A file with equal name, size, date and sampled bytes counts as the same.
 *
 * @param options.signal releases the scene, which is protected from removal until then or until the
 *   page ends.
 *
 * Rejects with WebSplatterError 'storage-unavailable' if the browser has no private file system,
 * SplatSourceError if the file cannot be read, and the signal's reason.
 *
 * @example
 * const bricks = await keptBricks(file);
 * const cloud = await engine.load(bricks ?? (await samplePly(file)));
 */
export async function keptBricks(
  file: File,
  options: Pick<KeepOptions, 'signal'> = {},
): Promise<File | null> {
  const { signal } = given(options);
  given(file, { slice: 'a function', name: 'a string' }, 'file');
  signal?.throwIfAborted();
  return useBricks(await sceneKey(file), file.name, signal);
}

/**
 * Converts a binary PLY of any size to a streamable file in bricks, for `engine.load`. It returns
 * at once if the file was converted before, see `keptBricks`. Splats and levels equal the output of
 * `websplatter convert`.
 *
 * Workers do the conversion; the result is stored in the private file system of the page's origin.
 * Interrupted work is resumed by the next call. If several pages request the same scene, one
 * converts it and the others wait. If storage is short, unused scenes are evicted, least recently
 * used first.
 *
 * The conversion takes up to 208 bytes of storage per splat, the result about 40.
 *
 * Rejects with StorageRoomError if storage is too small; SplatFileError as `samplePly`, or for
 * damaged files; SplatSourceError if the file cannot be read, or has changed. Rejects with
 * WebSplatterError 'storage-unavailable' as `keptBricks`, 'worker-failed' if a worker dies or
 * cannot start; and with the signal's reason.
 *
 * @example
 * const bricks = await keepBricks(file, { onProgress: (part) => console.log(`${Math.round(100 * part)} %`) });
 * const cloud = await engine.load(bricks);
 */
export async function keepBricks(file: File, options: KeepOptions = {}): Promise<File> {
  const { signal } = given(options);
  given(file, { slice: 'a function', name: 'a string' }, 'file');
  signal?.throwIfAborted();
  const key = await sceneKey(file);
  for (;;) {
    const bricks = await useBricks(key, file.name, signal);
    if (bricks) return bricks;
    await navigator.locks.request(lockName(key), { signal }, () => makeBricks(key, file, options));
  }
}

/** The bricks of a scene, locked until the signal aborts or the page ends; null if there are none. */
function useBricks(key: string, fileName: string, signal: AbortSignal | undefined): Promise<File | null> {
  return new Promise((resolve, reject) => {
    const use = async () => {
      const file = await findBricks(key);
      resolve(file && new File([file], fileName.replace(/(\.ply)?$/i, '.bricks')));
      if (!file || signal?.aborted) return;
      await new Promise((end) => signal?.addEventListener('abort', end, { once: true }));
    };
    navigator.locks.request(lockName(key), { mode: 'shared', signal }, use).catch(reject);
  });
}

/** Makes the bricks, unless another page has made them. The caller holds the scene's lock. */
async function makeBricks(key: string, file: File, { signal, onProgress }: KeepOptions): Promise<void> {
  const name = shortName(file.name);
  const failure = (event: Partial<ErrorEvent>) => workerStopped(name, 'worker that arranges it', event);
  const workers: Remote<typeof KEEP_TASKS>[] = [];
  const start = async () => {
    const find = async () => (await fetched('worker', import('./make-worker.ts'))).makeKeepWorker;
    const worker = await startWorker(find, signal);
    if (worker) workers.push(new Remote(() => worker, { failure }));
  };
  try {
    const cores = navigator.hardwareConcurrency ?? 1;
    const helperCount = Math.max(0, Math.min(MOST_HELPERS, cores - OTHER_THREADS));
    await Promise.all(Array.from({ length: 1 + helperCount }, start));
    const [worker, ...others] = workers;
    if (!worker) {
      const message = `${name}: the worker that arranges it could not be started.`;
      throw new WebSplatterError('worker-failed', message);
    }
    const helpers: MessagePort[] = [];
    const helping = others.map((other) => {
      const { port1, port2 } = new MessageChannel();
      helpers.push(port1);
      return other.call('help', port2, { transfer: [port2] });
    });
    const keeping = worker.call(
      'keep',
      { key, file, fileName: file.name, helpers },
      { signal, onProgress: (fraction) => callListener(onProgress, fraction), transfer: helpers },
    );
    // Helpers settle only if they die.
    const lack = await Promise.race([keeping, ...helping]);
    if (lack) throw new StorageRoomError(file.name, lack.neededBytes, lack.availableBytes);
  } finally {
    for (const each of workers) each.end();
  }
}

/** Bytes per sample; then the number of samples, from the beginning of the file to its end. */
const SAMPLE_BYTES = 1 << 16;
const SAMPLES = 5;

/** Hexadecimal digits of a key. */
const KEY_LENGTH = 32;

/**
 * Identifies a file and its version by name, size, date and samples from five places. Returns a
 * hash of 32 hexadecimal digits.
 *
 * Rejects if the file cannot be read.
 */
export async function sceneKey(file: File): Promise<string> {
  const { name, size, lastModified } = file;
  const parts: Blob[] = [new Blob([JSON.stringify([name, size, lastModified])])];
  for (let i = 0; i < SAMPLES; i++) {
    const at = Math.floor((Math.max(0, size - SAMPLE_BYTES) * i) / (SAMPLES - 1));
    parts.push(file.slice(at, at + SAMPLE_BYTES));
  }
  const digest = await crypto.subtle.digest('SHA-256', await new Blob(parts).arrayBuffer());
  const digits = Array.from(new Uint8Array(digest), (byte) => byte.toString(16).padStart(2, '0'));
  return digits.join('').slice(0, KEY_LENGTH);
}
