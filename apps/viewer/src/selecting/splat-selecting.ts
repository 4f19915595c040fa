import type { Region } from '../inspecting/inspect-messages.ts';
import type { InspectTools } from '../inspecting/inspect-tools.ts';
import { shownLook } from '../inspecting/shown-look.ts';
import { cloudKeys } from '../scene/shown-scene.ts';
import type { DragRegion, RowMasks, Selecting, SelectMode, SplatEdit } from '../state/selecting.ts';
import { removedUses } from './removed.ts';
import { joined, selectedWith, without } from './row-masks.ts';

/** So many steps can be undone: each holds a bit per splat. */
const MOST_STEPS = 32;
const NONE: RowMasks = new Map();

/** Selects splats by places in the picture, and removes them. */
export class SplatSelecting {
  readonly #tools: InspectTools;

  constructor(tools: InspectTools) {
    this.#tools = tools;
  }

  /** Sets the options of the next selection. */
  choose(change: Partial<Selecting>): void {
    this.#tools.update({ selecting: { ...this.#now, ...change } });
  }

  /** Selects splats, at any depth, with centres under a drag in an image of this size, CSS px. */
  async selectDragged(dragged: DragRegion, width: number, height: number, mode: SelectMode): Promise<void> {
    const look = shownLook(this.#tools);
    if (look) await this.select({ kind: 'dragged', dragged, width, height, look }, mode);
  }

  /** Selects all splats in the image. */
  async selectSeen(): Promise<void> {
    await this.selectDragged({ kind: 'rectangle', from: [0, 0], to: [1, 1] }, 1, 1, this.#now.mode);
  }

  async select(region: Region, mode = this.#now.mode): Promise<void> {
    const found = await this.#rowsWithin(region);
    if (!found) return;
    this.#take({ ...this.#now, selected: selectedWith(mode, this.#now, found) });
    if (found.size === 0) this.#tools.update({ problem: 'No splat has its centre there.' });
  }

  /** Selects all others that are not removed. */
  async invert(): Promise<void> {
    const all = await this.#rowsWithin({ kind: 'all' });
    if (!all) return;
    const { selected, removed } = this.#now;
    this.#take({ removed, selected: without(without(all, removed), selected) });
  }

  clear(): void {
    this.#take({ ...this.#now, selected: NONE });
  }

  /** Leaves the selected splats out of the picture and of saved files. */
  remove(): void {
    const { selected, removed } = this.#now;
    if (selected.size > 0) this.#take({ selected: NONE, removed: joined(removed, selected) });
  }

  /** Brings all removed splats back. */
  restore(): void {
    this.#take({ ...this.#now, removed: NONE });
  }

  undo(): void {
    const { past, undone, selected, removed } = this.#now;
    const before = past.at(-1);
    if (before)
      this.#show({ ...before, past: past.slice(0, -1), undone: [...undone, { selected, removed }] });
  }

  redo(): void {
    const { past, undone, selected, removed } = this.#now;
    const after = undone.at(-1);
    if (after) this.#show({ ...after, past: [...past, { selected, removed }], undone: undone.slice(0, -1) });
  }

  get #now(): Selecting {
    return this.#tools.store.getState().inspecting.selecting;
  }

  /** Undefined if the scene cannot be read. */
  async #rowsWithin(region: Region): Promise<RowMasks | undefined> {
    const { store, reader, viewer } = this.#tools;
    const scene = viewer.scenes.newest;
    if (!scene) return undefined;
    const { crop } = store.getState().inspecting;
    const found = await reader.ask('within', { region, crop });
    if (!found) return undefined;
    const keys = cloudKeys(scene);
    return without(new Map(found.map((words, i) => [keys[i], words])), NONE);
  }

  #take({ selected, removed }: SplatEdit): void {
    const { selected: selectedBefore, removed: removedBefore, past } = this.#now;
    const before = { selected: selectedBefore, removed: removedBefore };
    this.#show({ selected, removed, past: [...past, before].slice(-MOST_STEPS), undone: [] });
  }

  #show(edit: Pick<Selecting, 'selected' | 'removed' | 'past' | 'undone'>): void {
    const { update, viewer } = this.#tools;
    const isOther = edit.removed !== this.#now.removed;
    update({ selecting: { ...this.#now, ...edit }, problem: null });
    if (isOther) viewer.setEffects('removed', removedUses(edit.removed));
  }
}
