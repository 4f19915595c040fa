import { defineEffect, type SplatSelection } from '@websplatter/core/effects';
import type { SceneEdit } from '../state/inspecting.ts';
import type { CloudEffects } from '../state/requested-effects.ts';
import type { RowMasks } from '../state/selecting.ts';
import { drawCrop } from './draw-crop.ts';
import type { InspectTools } from './inspect-tools.ts';
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
function removedUses(masks: RowMasks): CloudEffects {
  return new Map([...masks].map(([key, words]) => [key, [removed(selectionOf(words))]]));
}

/** So many steps can be undone: each holds a bit per splat. */
const MOST_STEPS = 32;

/** Steps through crops, selections and removals, back and forth. */
export class EditHistory {
  readonly #tools: Pick<InspectTools, 'store' | 'viewer' | 'update'>;
  #gesture: unknown = null;

  constructor(tools: Pick<InspectTools, 'store' | 'viewer' | 'update'>) {
    this.#tools = tools;
  }

  get now(): SceneEdit {
    const { crop, selecting } = this.#tools.store.getState().inspecting;
    return { crop, selected: selecting.selected, removed: selecting.removed };
  }

  /** What a change of `gesture` begins with: the edit before its first one. */
  before(gesture: unknown): SceneEdit {
    const last = this.#tools.store.getState().inspecting.past.at(-1);
    return gesture !== null && gesture === this.#gesture && last ? last : this.now;
  }

  /** @param gesture changes of one gesture in a row are one step; null for a step of its own. */
  take(change: Partial<SceneEdit>, gesture: unknown = null): void {
    const { past } = this.#tools.store.getState().inspecting;
    const before = this.before(gesture);
    const steps = before === past.at(-1) ? past : [...past, before].slice(-MOST_STEPS);
    this.#show({ ...this.now, ...change }, steps, []);
    this.#gesture = gesture;
  }

  undo(): void {
    const { past, undone } = this.#tools.store.getState().inspecting;
    const before = past.at(-1);
    if (before) this.#show(before, past.slice(0, -1), [...undone, this.now]);
  }

  redo(): void {
    const { past, undone } = this.#tools.store.getState().inspecting;
    const after = undone.at(-1);
    if (after) this.#show(after, [...past, this.now], undone.slice(0, -1));
  }

  #show({ crop, ...splats }: SceneEdit, past: readonly SceneEdit[], undone: readonly SceneEdit[]): void {
    const { store, viewer, update } = this.#tools;
    const before = this.now;
    this.#gesture = null;
    const { selecting, cropCount } = store.getState().inspecting;
    update({
      crop,
      cropCount: crop === before.crop ? cropCount : null,
      selecting: { ...selecting, ...splats, picked: null },
      past,
      undone,
      problem: null,
    });
    if (splats.removed !== before.removed) viewer.setEffects('removed', removedUses(splats.removed));
    if (crop !== before.crop) drawCrop(this.#tools);
  }
}
