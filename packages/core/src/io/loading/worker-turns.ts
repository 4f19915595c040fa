import { onAbort } from '../../data/on-abort.ts';

/** Fewest and most loads that run at once, whatever the machine says of itself. */
const FEWEST = 2;
const MOST = 8;

type Take = (spare: Worker | null) => void;

/** First come, first served. */
const waiting = new Set<Take>();
let running = 0;

/**
 * Waits until a load may run: as many do at once as the machine has threads. Resolves with the
 * worker of a load that has ended, or with null if there is none. `endTurn` must follow.
 *
 * Rejects with the signal's reason; no turn is taken then.
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

/** Lets the next load run, with `spare` as its worker; without a next one, the worker ends. */
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
