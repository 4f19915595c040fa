import { defineEffect, type SplatSelection } from '@websplatter/core/effects';
import type { CloudEffects } from '../state/effects.ts';
import { History, replacement, type Steps } from '../state/history.ts';
import type { Crop } from '../state/inspecting.ts';
import type { RowMasks, SplatEdit } from '../state/selecting.ts';
import { drawCrop } from './draw-crop.ts';
import type { InspectTools } from './inspect-tools.ts';
import removedWgsl from './removed.wgsl?raw';
import { selectionOf } from './row-masks.ts';

/** Most edits that can be undone: each holds one bit per splat. */
const MOST_EDITS = 32;

/** All state that edits change. */
interface EditedScene extends SplatEdit {
  readonly crop: Crop | null;
}

/** Undoes and redoes crops, selections and removals. */
export class EditHistory extends History {
  readonly #tools: Pick<InspectTools, 'store' | 'viewer' | 'update'>;
  /** The state before the newest edit or gesture. */
  #before: EditedScene;

  constructor(tools: Pick<InspectTools, 'store' | 'viewer' | 'update'>) {
    super(() => tools.store.getState().inspecting, MOST_EDITS);
    this.#tools = tools;
    this.#before = this.#now;
  }

  get #now(): EditedScene {
    const { crop, selecting } = this.#tools.store.getState().inspecting;
    return { crop, selected: selecting.selected, removed: selecting.removed };
  }

  /** The state before the first edit of `gesture`. */
  before(gesture: unknown): EditedScene {
    return this.continues(gesture) ? this.#before : this.#now;
  }

  /**
   * @param gesture successive edits with the same gesture are one undo step; null for a separate
   * step.
   */
  edit(name: string, change: Partial<EditedScene>, gesture: unknown = null): void {
    this.#before = this.before(gesture);
    const next = { ...this.#now, ...change };
    const show = (scene: EditedScene, steps: Steps) => this.#show(scene, steps);
    this.take(
      replacement(name, next, () => this.#now, show),
      gesture,
    );
  }

  #show({ crop, ...splats }: EditedScene, steps: Steps): void {
    const { store, viewer, update } = this.#tools;
    const before = this.#now;
    const { selecting, cropCount } = store.getState().inspecting;
    update({
      crop,
      cropCount: crop === before.crop ? cropCount : null,
      selecting: { ...selecting, ...splats, picked: null },
      ...steps,
      problem: null,
    });
    if (splats.removed !== before.removed) viewer.setEffects('removed', removedUses(splats.removed));
    if (crop !== before.crop) drawCrop(this.#tools);
  }
}

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

/** Effects that hide the removed splats. */
function removedUses(masks: RowMasks): CloudEffects {
  return new Map([...masks].map(([key, words]) => [key, [removed(selectionOf(words))]]));
}
