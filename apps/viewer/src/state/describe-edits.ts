import { formatCount } from '@websplatter/kit/format';
import type { Inspecting } from './inspecting.ts';
import { countOf } from './selecting.ts';

const LIST = new Intl.ListFormat('en');

/** What a person has made of a scene that no file has: `a crop, 918 removed splats and 2 rulers`; empty without any. */
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
