import type { DropCounts, DropReason } from '@websplatter/core';

/** NaN and infinities are not finite; an opacity's logit may be infinite. */
const REASONS: Readonly<Record<DropReason, string>> = {
  'non-finite-position': 'Position is not a finite number',
  'non-finite-scale': 'Scale is not a finite number',
  'non-finite-rotation': 'Rotation is not a finite number',
  'non-finite-opacity': 'Opacity is not a number',
  'non-finite-color': 'Colour is not a finite number',
  'non-finite-motion': 'Motion is not a finite number, or above 10¹²',
};

export interface DroppedReason {
  readonly reason: DropReason;
  /** Text for the interface. */
  readonly words: string;
  readonly count: number;
}

/** Why rows were left out, the most frequent reason first. */
export function droppedReasons(dropped: DropCounts): DroppedReason[] {
  return (Object.keys(REASONS) as DropReason[])
    .map((reason) => ({ reason, words: REASONS[reason], count: dropped[reason] ?? 0 }))
    .filter(({ count }) => count > 0)
    .sort((a, b) => b.count - a.count);
}

export function droppedTotal(dropped: DropCounts): number {
  return droppedReasons(dropped).reduce((sum, { count }) => sum + count, 0);
}
