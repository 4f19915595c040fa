import { onAbort } from '../../data/on-abort.ts';

/** Resolves after `ms` milliseconds; rejects with the signal's reason as soon as it aborts. */
export function waitMs(ms: number, signal: AbortSignal | undefined): Promise<void> {
  return new Promise((resolve, reject) => {
    if (signal?.aborted) return reject(signal.reason);
    const timer = setTimeout(() => {
      ignoreSignal();
      resolve();
    }, ms);
    const ignoreSignal = onAbort(signal, () => {
      clearTimeout(timer);
      reject(signal!.reason);
    });
  });
}
