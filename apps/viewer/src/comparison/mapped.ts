import { ACCURACY_PRESETS } from '@websplatter/core';
import { isSameAccuracy } from '../formatting/nearest-preset.ts';
import type { Drawn } from '../state/comparison.ts';

const { reference, fast } = ACCURACY_PRESETS;

/** What is compared with `reference`: what is drawn, or `fast` where that is `reference` itself. */
export function mapped(drawn: Drawn): Drawn {
  const isReference = drawn.detail === 'full' && isSameAccuracy(drawn.accuracy, reference);
  return isReference ? { accuracy: fast, detail: 'full' } : drawn;
}
