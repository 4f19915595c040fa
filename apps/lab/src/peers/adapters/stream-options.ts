import type { AccuracyPreset, CloudStream } from '@websplatter/core';

/**
 * Options of the page's URL for a scene that streams: `accuracy=PRESET`; `maxSplats=N` are drawn at
 * most and `budgetBytes=N` held on the GPU, without limits where these are missing.
 */
export function streamOptions(options: URLSearchParams) {
  const limit = (name: string) => Number(options.get(name) ?? Number.POSITIVE_INFINITY);
  const [maxSplats, budgetBytes] = [limit('maxSplats'), limit('budgetBytes')];
  const accuracy = (options.get('accuracy') ?? 'balanced') as AccuracyPreset;
  return {
    accuracy,
    budgetBytes,
    detail: Number.isFinite(maxSplats) ? { maxSplats } : 'full',
    note: `${accuracy}, maxSplats ${maxSplats}, budgetBytes ${budgetBytes}`,
  } as const;
}

/** @throws the error of the last fetch, if it failed. */
export function isStreamComplete(stream: CloudStream): boolean {
  const { isComplete, error } = stream.report();
  if (error) throw error;
  return isComplete;
}
