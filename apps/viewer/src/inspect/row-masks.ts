import { SplatSelection } from '@websplatter/core/effects';
import type { RowMasks, SelectMode, SplatEdit } from '../state/selecting.ts';

/** The selection after `found` was selected with `mode`. Removed splats are never selected. */
export function selectedWith(mode: SelectMode, { selected, removed }: SplatEdit, found: RowMasks): RowMasks {
  switch (mode) {
    case 'replace':
      return without(found, removed);
    case 'add':
      return joined(selected, without(found, removed));
    case 'subtract':
      return without(selected, found);
  }
}

/** Rows in `a` or `b`. */
export function joined(a: RowMasks, b: RowMasks): RowMasks {
  const masks = new Map(a);
  for (const [key, words] of b) {
    const others = masks.get(key) ?? words;
    const both = new Uint32Array(Math.max(words.length, others.length));
    both.set(words);
    for (let i = 0; i < others.length; i++) both[i] |= others[i];
    masks.set(key, both);
  }
  return masks;
}

/** Rows of `a` that are not in `b`. */
export function without(a: RowMasks, b: RowMasks): RowMasks {
  const masks = new Map<string, Uint32Array<ArrayBuffer>>();
  for (const [key, words] of a) {
    const others = b.get(key);
    const left = words.slice();
    const shared = Math.min(left.length, others?.length ?? 0);
    for (let i = 0; others && i < shared; i++) left[i] &= ~others[i];
    if (left.some((word) => word !== 0)) masks.set(key, left);
  }
  return masks;
}

/** Caches the selection of each mask, so that engine and counts process its bits once. */
const selections = new WeakMap<Uint32Array, SplatSelection>();

/** The rows of a mask as effects expect them; must not be changed. */
export function selectionOf(words: Uint32Array): SplatSelection {
  const known = selections.get(words);
  if (known) return known;
  const selection = new SplatSelection();
  selection.setWords(words);
  selections.set(words, selection);
  return selection;
}
