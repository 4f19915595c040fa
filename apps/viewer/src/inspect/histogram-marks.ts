import { cloudKeys } from '../engine/shown-scene.ts';
import type { MarkedBin } from '../state/inspecting.ts';
import type { RowMasks } from '../state/selecting.ts';
import type { InspectTools } from './inspect-tools.ts';

/** Counts splats by their values, and finds those of a bin. */
export class HistogramMarks {
  readonly #tools: InspectTools;
  /** Rows of the marked bin, once they are known. */
  #rows: RowMasks | null = null;

  constructor(tools: InspectTools) {
    this.#tools = tools;
  }

  get rows(): RowMasks | null {
    return this.#rows;
  }

  /** Counts, unless it is known already. */
  async count(): Promise<void> {
    const { store, reader, update } = this.#tools;
    const { histograms, marked } = store.getState().inspecting;
    if (marked && !this.#rows) void this.mark(marked);
    if (histograms) return;
    const counted = await reader.ask('histograms', null);
    if (counted) update({ histograms: counted });
  }

  /** Another scene is shown. */
  forget(): void {
    this.#rows = null;
  }

  /** Marks the splats of a bin in the image, or with null none. */
  async mark(marked: MarkedBin | null): Promise<void> {
    const { store, reader, viewer, update } = this.#tools;
    if (!marked) this.forget();
    update({ marked });
    const scene = viewer.scenes.newest;
    if (!marked || !scene) return;
    const masks = await reader.ask('within', { region: { kind: 'bin', marked }, crop: null });
    if (!masks || store.getState().inspecting.marked !== marked) return;
    const keys = cloudKeys(scene);
    this.#rows = new Map(masks.map((words, i) => [keys[i], words]));
    // The same bin, whose splats are known now.
    update({ marked: { ...marked } });
  }
}
