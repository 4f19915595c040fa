import type { DropCounts, DropReason } from '@websplatter/core';
import { formatCount } from '@websplatter/kit/format';
import type { SceneWarning } from '../state/scene.ts';

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

/** A warning if at least half of the rows were dropped, which changes the image; else null. */
export function droppedWarning(name: string, kept: number, dropped: DropCounts): SceneWarning | null {
  const left = droppedTotal(dropped);
  const rows = kept + left;
  if (left === 0 || left < rows / 2) return null;
  // Rounded down: 100% would say that nothing is shown.
  const percent = Math.floor((100 * left) / rows);
  const part = left === rows / 2 ? 'Half' : percent === 50 ? 'More than half' : `${percent}%`;
  return {
    title: `${part} of the splats were left out`,
    message: `${formatCount(left)} of the ${formatCount(rows)} rows in ${name} hold values that are not usable numbers. The rest is shown, but the file is probably damaged.`,
  };
}
