import { hostedWorker } from '../io/loading/hosted-worker.ts';
import { fromPostedError } from '../io/loading/load-messages.ts';
import { startWorker, workerStopped } from '../io/loading/start-worker.ts';
import { endWorker } from '../io/loading/try-worker.ts';
import { endTurn, takeTurn } from '../io/loading/worker-turns.ts';
import type { ClusterOptions } from '../packing/cluster-harmonics.ts';
import type { PackedHarmonics } from '../packing/harmonics.ts';
import type { HarmonicsPalette } from '../packing/harmonics-palette.ts';
import type { PaletteReply, PaletteRequest } from './palette-messages.ts';

export interface FindPaletteOptions extends Pick<ClusterOptions, 'entryCount' | 'signal' | 'onProgress'> {
  /** For messages. */
  readonly name: string;
  /** Whether the memory of the harmonics may be given away; otherwise a worker gets a copy. */
  readonly isGiven: boolean;
}

/**
 * Does what `clusterHarmonics` does, in a worker where one can start, else in turns in the calling thread. It takes its turn with
 * loads, so that no more threads are at work than the machine has.
 *
 * Rejects as `clusterHarmonics`; with `WebSplatterError` 'worker-failed' if the worker dies, mostly for lack of memory; and with the
 * signal's reason, in which case the worker is stopped at once.
 */
export async function findPalette(
  harmonics: PackedHarmonics,
  count: number,
  options: FindPaletteOptions,
): Promise<HarmonicsPalette> {
  const { entryCount, signal, onProgress } = options;
  signal?.throwIfAborted();
  // The spare worker of a load reads files, and nothing else.
  endWorker(await takeTurn(signal));
  let worker: Worker | null = null;
  try {
    // In one piece, since this is the form that bundlers recognise.
    const make = () => new Worker(new URL('./palette-worker.ts', import.meta.url), { type: 'module' });
    worker = await startWorker(async () => hostedWorker() ?? make, signal);
    if (worker) return await findInWorker(worker, harmonics, count, options);
    const { clusterHarmonics } = await import('../packing/cluster-harmonics.ts');
    return await clusterHarmonics(harmonics, count, { entryCount, signal, onProgress });
  } finally {
    endWorker(worker);
    endTurn(null);
  }
}

function findInWorker(
  worker: Worker,
  harmonics: PackedHarmonics,
  count: number,
  { entryCount, name, isGiven, signal, onProgress }: FindPaletteOptions,
): Promise<HarmonicsPalette> {
  signal?.throwIfAborted();
  return new Promise<HarmonicsPalette>((resolve, reject) => {
    signal?.addEventListener('abort', () => reject(signal.reason), { once: true });
    const fail = (event: Partial<ErrorEvent>) => reject(workerStopped(name, 'palette worker', event));
    worker.onerror = fail;
    worker.onmessageerror = fail;
    worker.onmessage = ({ data }: MessageEvent<PaletteReply>) => {
      if (data.kind === 'palette') resolve(data.palette);
      else if (data.kind === 'error') reject(fromPostedError(data.error));
      else if (data.kind === 'progress') {
        try {
          onProgress?.(data.part);
        } catch (error) {
          reject(error);
        }
      }
    };
    const request: PaletteRequest = { harmonics, count, entryCount };
    worker.postMessage(request, isGiven ? [harmonics.words.buffer as ArrayBuffer] : []);
  });
}
