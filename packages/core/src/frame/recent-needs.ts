import type { FrameNeeds } from './frame-plan.ts';
import { RecentPeak } from './recent-peak.ts';

/** Wide keys cost a pass more; other widths need other buffers and bindings, which take longer. */
const KEYS_PERIOD_MS = 30_000;

/** Needs of a view's recent frames, as long as they show the same clouds. */
export class RecentNeeds {
  readonly #visibleSplats = new RecentPeak();
  /** Powers of two, so that a need of fewer bits is less than half. */
  readonly #depths = new RecentPeak(KEYS_PERIOD_MS);

  /** The largest needs of recent frames; of nothing before the first. */
  get value(): FrameNeeds {
    return { visibleSplats: this.#visibleSplats.value, depthBits: Math.log2(this.#depths.value) };
  }

  /** Takes the needs of a frame that was drawn at `atMs`. */
  take({ visibleSplats, depthBits }: FrameNeeds, atMs: number): void {
    this.#visibleSplats.take(visibleSplats, atMs);
    this.#depths.take(2 ** depthBits, atMs);
  }
}
