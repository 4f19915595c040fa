import type { Detail } from '@websplatter/core';
import type { Drawn } from '../state/comparison.ts';
import { describeAccuracy } from './accuracy-words.ts';
import { formatMany } from './format.ts';

/** Words for each limit that a detail may have. */
const LIMITS: Readonly<Record<string, (limit: number) => string>> = {
  maxErrorPx: (px) => `errors up to ${px} px`,
  maxSplats: (splats) => `at most ${formatMany(splats)} splats`,
};

/** `at most 1.2 million splats`; empty for full detail. */
export function describeDetail(detail: Detail): string {
  if (detail === 'full') return '';
  return Object.entries(detail)
    .map(([name, limit]) => LIMITS[name](limit))
    .join(', ');
}

/** `balanced, at most 1.2 million splats`. */
export function describeDrawn({ accuracy, detail }: Drawn): string {
  return [describeAccuracy(accuracy), describeDetail(detail)].filter(Boolean).join(', ');
}
