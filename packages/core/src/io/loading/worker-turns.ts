import { onAbort } from '../../data/on-abort.ts';

/** Bounds of the number of parallel loads, to which the reported hardware threads are clamped. */
const FEWEST = 2;
const MOST = 8;

type Take = (spare: Worker | null) => void;

/** First in, first out. */
const waiting = new Set<Take>();
let running = 0;

/**
 * Waits for a free slot; there are as many as hardware threads. Resolves with the spare worker of a
 * finished load, or with null if there is none. Call `endTurn` afterwards.
 *
 * Rejects with the signal's reason; no slot is taken then.
 */
export async function takeTurn(signal: AbortSignal | undefined): Promise<Worker | null> {
  const threads = globalThis.navigator?.hardwareConcurrency ?? FEWEST;
  if (running < Math.min(Math.max(threads, FEWEST), MOST)) {
    running++;
    return null;
  }
  return new Promise((resolve, reject) => {
    const take: Take = (spare) => {
      ignoreSignal();
      resolve(spare);
    };
    const ignoreSignal = onAbort(signal, () => {
      waiting.delete(take);
      reject(signal?.reason);
    });
    waiting.add(take);
  });
}

/**
 * Frees the slot and passes `spare` to the next load in the queue. If the queue is empty, the
 * worker ends.
 */
export function endTurn(spare: Worker | null): void {
  const [next] = waiting;
  if (next) {
    waiting.delete(next);
    next(spare);
  } else {
    running--;
    spare?.terminate();
  }
}
