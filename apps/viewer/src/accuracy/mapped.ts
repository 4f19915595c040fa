import { ACCURACY_PRESETS } from '@websplatter/core';
import type { Drawn } from '../state/comparison.ts';
import { isSameAccuracy } from '../state/nearest-preset.ts';

const { reference, fast } = ACCURACY_PRESETS;

/** What is compared with `reference`: what is drawn, or `fast` where that is `reference` itself. */
export function mapped(drawn: Drawn): Drawn {
  const isReference = drawn.detail === 'full' && isSameAccuracy(drawn.accuracy, reference);
  return isReference ? { accuracy: fast, detail: 'full' } : drawn;
}
