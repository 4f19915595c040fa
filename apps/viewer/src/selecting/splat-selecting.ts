import type { EditHistory } from '../inspecting/edit-history.ts';
import type { Region } from '../inspecting/inspect-messages.ts';
import type { InspectTools } from '../inspecting/inspect-tools.ts';
import { shownLook } from '../inspecting/shown-look.ts';
import { cloudKeys } from '../scene/shown-scene.ts';
import type { DragRegion, RowMasks, Selecting, SelectMode } from '../state/selecting.ts';
import { joined, selectedWith, without } from './row-masks.ts';

const NONE: RowMasks = new Map();

/** Selects splats by places in the picture, and removes them. */
export class SplatSelecting {
  readonly #tools: InspectTools;
  readonly #history: EditHistory;

  constructor(tools: InspectTools, history: EditHistory) {
    this.#tools = tools;
    this.#history = history;
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
    this.#history.take({ selected: selectedWith(mode, this.#now, found) });
    if (found.size === 0) this.#tools.update({ problem: 'No splat has its centre there.' });
  }

  /** Selects all others that are not removed. */
  async invert(): Promise<void> {
    const all = await this.#rowsWithin({ kind: 'all' });
    if (!all) return;
    const { selected, removed } = this.#now;
    this.#history.take({ selected: without(without(all, removed), selected) });
  }

  clear(): void {
    this.#history.take({ selected: NONE });
  }

  /** Leaves the selected splats out of the picture and of saved files. */
  remove(): void {
    const { selected, removed } = this.#now;
    if (selected.size > 0) this.#history.take({ selected: NONE, removed: joined(removed, selected) });
  }

  /** Brings all removed splats back. */
  restore(): void {
    this.#history.take({ removed: NONE });
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
}
