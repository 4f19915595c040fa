import { defineEffect, type SplatSelection } from '@websplatter/core/effects';
import type { CloudEffects } from '../state/effects.ts';
import type { Edit } from '../state/history.ts';
import type { Crop, Ruler } from '../state/inspecting.ts';
import { continuesEdit, makeEdit, replacement } from '../state/make-edit.ts';
import type { RowMasks, SplatEdit } from '../state/selecting.ts';
import { drawCrop } from './draw-crop.ts';
import type { InspectTools } from './inspect-tools.ts';
import removedWgsl from './removed.wgsl?raw';
import { selectionOf } from './row-masks.ts';

/** All state of the panel Inspect that edits change. */
interface EditedScene extends SplatEdit {
  readonly crop: Crop | null;
  readonly rulers: readonly Ruler[];
}

/** Makes edits of crop, selection, removed splats and rulers. */
export class EditHistory {
  readonly #tools: Pick<InspectTools, 'store' | 'viewer' | 'update'>;
  /** The state before the newest edit or gesture. */
  #before: EditedScene;

  constructor(tools: Pick<InspectTools, 'store' | 'viewer' | 'update'>) {
    this.#tools = tools;
    this.#before = this.#now;
  }

  get #now(): EditedScene {
    const { crop, rulers, selecting } = this.#tools.store.getState().inspecting;
    return { crop, rulers, selected: selecting.selected, removed: selecting.removed };
  }

  /** The state before the first edit of `gesture`. */
  before(gesture: unknown): EditedScene {
    return continuesEdit(this.#tools.store, gesture) ? this.#before : this.#now;
  }

  /**
   * @param name lower case, shown as in "Undo crop".
   * @param gesture successive edits with the same gesture are one undo step; null for a separate
   * step.
   * @param beside a change outside of crop, selection and rulers: done after it, undone before it.
   */
  edit(
    name: string,
    change: Partial<EditedScene>,
    gesture: unknown = null,
    beside?: Pick<Edit, 'do' | 'undo'>,
  ): void {
    this.#before = this.before(gesture);
    const next = { ...this.#now, ...change };
    const edit: Edit = {
      ...replacement(
        name,
        next,
        () => this.#now,
        (scene) => this.#show(scene),
      ),
      bytes: bytesOf(change.selected) + bytesOf(change.removed),
    };
    const whole: Edit = beside
      ? {
          ...edit,
          do: () => {
            edit.do();
            beside.do();
          },
          undo: () => {
            beside.undo();
            edit.undo();
          },
        }
      : edit;
    makeEdit(this.#tools.store, whole, gesture);
  }

  #show({ crop, rulers, ...splats }: EditedScene): void {
    const { store, viewer, update } = this.#tools;
    const before = this.#now;
    const { selecting, cropCount } = store.getState().inspecting;
    update({
      crop,
      rulers,
      cropCount: crop === before.crop && splats.removed === before.removed ? cropCount : null,
      selecting: { ...selecting, ...splats, picked: null },
      problem: null,
    });
    if (splats.removed !== before.removed) viewer.setEffects('removed', removedUses(splats.removed));
    if (crop !== before.crop) drawCrop(this.#tools);
  }
}

/** Memory of masks, which edits that leave them as they are share. */
function bytesOf(masks: RowMasks = new Map()): number {
  return [...masks.values()].reduce((sum, { byteLength }) => sum + byteLength, 0);
}

const removed = defineEffect<SplatSelection>({
  name: 'removed',
  label: 'Removed splats',
  about: 'Hides splats that were selected and removed.',
  hooks: { splat: 'removeSplat' },
  wgsl: removedWgsl,
  calledFor: ({ size }) => (size === 0 ? null : `${size} ${size === 1 ? 'splat is' : 'splats are'} removed`),
  selection: (selection) => selection,
});

/** Effects that hide the removed splats. */
function removedUses(masks: RowMasks): CloudEffects {
  return new Map([...masks].map(([key, words]) => [key, [removed(selectionOf(words))]]));
}
