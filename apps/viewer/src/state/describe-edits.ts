import { formatCount } from '@websplatter/kit/format';
import type { Inspecting } from './inspecting.ts';
import { countOf } from './selecting.ts';

const LIST = new Intl.ListFormat('en');

/** Lists unsaved edits of a scene, as in `a crop and 918 removed splats`; empty if there are none. */
export function describeEdits({
  crop,
  rulers,
  selecting,
}: Pick<Inspecting, 'crop' | 'rulers' | 'selecting'>): string {
  const removed = countOf(selecting.removed);
  return LIST.format([
    ...(crop ? ['a crop'] : []),
    ...(removed > 0 ? [counted(removed, 'removed splat')] : []),
    ...(rulers.length > 0 ? [counted(rulers.length, 'ruler')] : []),
  ]);
}

/** `1 ruler`, `918 removed splats`. */
export function counted(count: number, what: string): string {
  return `${formatCount(count)} ${what}${count === 1 ? '' : 's'}`;
}
