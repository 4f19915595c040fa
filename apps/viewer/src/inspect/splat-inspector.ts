import { traceSplat } from '@websplatter/core/reference';
import type { InspectedSplat } from '../state/inspecting.ts';
import type { InspectTools } from './inspect-tools.ts';
import { pickSplat } from './pick-splat.ts';

/** Inspects one splat at a time. */
export class SplatInspector {
  readonly #tools: InspectTools;

  constructor(tools: InspectTools) {
    this.#tools = tools;
  }

  /** Inspects the splat that contributes most at `xPart`, `yPart` from the image's top left. */
  async pickAt(xPart: number, yPart: number): Promise<void> {
    const { store, update } = this.#tools;
    const pick = await pickSplat(this.#tools, xPart, yPart);
    if (!pick) {
      update({ splat: null, problem: 'No splat is drawn there.' });
      return;
    }
    const { cloudIndex, row, alpha, weight, totalOpacity, rank } = pick;
    const { statistics } = store.getState();
    const visible = (statistics?.cutErrorPx === null && statistics.visibleSplats) || null;
    const share = { alpha, weight, totalOpacity, rank, visible };
    await this.#take({ cloudIndex, row, share, set: null, seen: null });
  }

  /** Inspects the splat in a row of the first cloud's file. */
  async showRow(row: number): Promise<void> {
    await this.#take({ cloudIndex: 0, row, share: null, set: null, seen: null });
  }

  /** Computes how the splat appears in the current image. */
  trace(): void {
    const { viewer, store, update } = this.#tools;
    const { inspecting, accuracy } = store.getState();
    const { splat } = inspecting;
    if (!splat?.set) return;
    const frame = viewer.shownFrame?.frame;
    const cloud = frame?.clouds[splat.cloudIndex];
    const { alphaCutoff } = accuracy;
    const seen =
      frame && cloud
        ? traceSplat(splat.set, 0, { ...frame, modelMatrix: cloud.modelMatrix, alphaCutoff })
        : null;
    update({ splat: { ...splat, seen } });
  }

  /** Continues with a splat whose values were not read before the panel was closed. */
  resume(): void {
    const { splat } = this.#tools.store.getState().inspecting;
    if (splat && !splat.set) void this.#take(splat);
    else this.trace();
  }

  async #take(splat: InspectedSplat): Promise<void> {
    const { store, reader, update } = this.#tools;
    update({ splat, problem: null });
    const { cloudIndex, row } = splat;
    const set = await reader.ask('splat', { cloudIndex, row });
    const now = store.getState().inspecting.splat;
    // Another splat was requested meanwhile, or the file cannot be read, which the panel reports.
    if (set === undefined || now?.row !== row || now.cloudIndex !== cloudIndex) return;
    if (set === null) {
      update({ splat: null, problem: `The file has no splat in row ${row}.` });
      return;
    }
    update({ splat: { ...now, set } });
    this.trace();
  }
}
