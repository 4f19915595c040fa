import type { Detail } from '@websplatter/core';
import { formatMany } from '@websplatter/kit/format';
import type { Drawn } from '../state/comparison.ts';
import { describeAccuracy } from './accuracy-words.ts';

/** Words for each limit or target of a detail. */
const NUMBERS: Readonly<Record<string, (value: number) => string>> = {
  maxErrorPx: (px) => `errors up to ${px} px`,
  maxSplats: (splats) => `at most ${formatMany(splats)} splats`,
  maxShare: (share) => `at most ${Number((100 * share).toPrecision(3))} % of the splats in sight`,
  maxFrameMs: (ms) => `splats for ${ms} ms`,
  minPsnrDb: (db) => `splats for ${db} dB`,
};

/** `at most 1.2 million splats`; empty for full detail. */
export function describeDetail(detail: Detail): string {
  if (typeof detail === 'string') return detail === 'full' ? '' : 'automatic detail';
  return Object.entries(detail)
    .map(([name, value]) => NUMBERS[name](value))
    .join(', ');
}

/** `balanced, at most 1.2 million splats`. */
export function describeDrawn({ accuracy, detail }: Drawn): string {
  return [describeAccuracy(accuracy), describeDetail(detail)].filter(Boolean).join(', ');
}
