import type { TimeRange } from '@websplatter/core';

/** Files do not say how long a moving scene lasts: most are captures of two to ten seconds. */
const LOOP_MS = 5000;

/** Time of a playing scene `elapsedMs` after `from`; after its end it begins anew. */
export function timeAfter([first, last]: TimeRange, from: number, elapsedMs: number): number {
  const length = last - first;
  const part = (from - first) / length + elapsedMs / LOOP_MS;
  return first + length * (part - Math.floor(part));
}
