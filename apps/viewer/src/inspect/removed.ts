import { defineEffect, type SplatSelection } from '@websplatter/core/effects';
import type { CloudEffects } from '../state/requested-effects.ts';
import type { RowMasks } from '../state/selecting.ts';
import removedWgsl from './removed.wgsl?raw';
import { selectionOf } from './row-masks.ts';

const removed = defineEffect<SplatSelection>({
  name: 'removed',
  label: 'Removed splats',
  about: 'Hides splats that were selected and removed.',
  hooks: { splat: 'removeSplat' },
  wgsl: removedWgsl,
  calledFor: ({ count }) =>
    count === 0 ? null : `${count} ${count === 1 ? 'splat is' : 'splats are'} removed`,
  selection: (selection) => selection,
});

/** Effects that leave out these splats. */
export function removedUses(masks: RowMasks): CloudEffects {
  return new Map([...masks].map(([key, words]) => [key, [removed(selectionOf(words))]]));
}
