import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import type { StageTimings } from '../gpu/timing/frame-statistics.ts';

/**
 * An eighth of the two seconds after which Windows resets a driver, so that a frame may take eight
 * times what was foreseen, as where the camera jumps. Twice the longest frame at which a page still
 * seems to follow the hand.
 */
export const DEFAULT_SUBMISSION_BUDGET_MS = 250;

/** Time of a pixel of a quad or tile on the slowest devices: in software on a core or two. */
const SLOWEST_PIXEL_MS = 2e-5;
/** Time there of a splat that covers no pixel. */
const SLOWEST_SPLAT_MS = 4e-3;

/**
 * Frames of which one must have been short by the wall clock: other work of the page or the browser
 * makes one seem long.
 */
const WALL_CLOCK_FRAMES = 3;

export type ForecastPlan = Pick<FramePlan, 'needs' | 'layer'> & {
  readonly clouds: readonly { readonly instance: { readonly cloud: SplatCloud } }[];
};

/**
 * Foresees from measured frames whether one submission may draw a view's next frame. It may where
 * even the slowest device would be done in time with splats that all cover the whole image;
 * otherwise only frames of clouds that were drawn before, as long as the last of them was short
 * enough for what has been added since.
 */
export class SubmissionForecast {
  readonly #budgetMs: number;
  /** By the storage of their planes, which the previews of a load share. */
  readonly #drawn = new WeakSet<object>();
  #elapsedMs = 0;
  /** Time that the last measured frame might have taken the slowest device. */
  #slowestMs = 0;
  #wallClocksMs: number[] = [];

  constructor(budgetMs: number) {
    this.#budgetMs = budgetMs;
  }

  /** Whether the frame may take longer than the budget. */
  mayExceed(plan: ForecastPlan): boolean {
    const slowestMs = slowestFrameMs(plan);
    if (slowestMs <= this.#budgetMs) return false;
    if (plan.clouds.some(({ instance }) => !this.#drawn.has(instance.cloud.planes.storage))) return true;
    return this.#elapsedMs * Math.max(1, slowestMs / this.#slowestMs) > this.#budgetMs;
  }

  /** Takes the times of a frame that one submission drew. */
  take(plan: ForecastPlan, { totalMs, wallClockMs }: Pick<StageTimings, 'totalMs' | 'wallClockMs'>): void {
    this.#wallClocksMs = [...this.#wallClocksMs.slice(1 - WALL_CLOCK_FRAMES), wallClockMs];
    // Some browsers' timestamps have been seen to be a hundredth of the truth.
    this.#take(plan, Math.max(totalMs, Math.min(...this.#wallClocksMs)));
  }

  /** Takes the time of all submissions of a frame together, without pauses between them. */
  takeParts(plan: ForecastPlan, elapsedMs: number): void {
    this.#wallClocksMs = [elapsedMs];
    this.#take(plan, elapsedMs);
  }

  #take(plan: ForecastPlan, elapsedMs: number): void {
    this.#elapsedMs = elapsedMs;
    this.#slowestMs = slowestFrameMs(plan);
    for (const { instance } of plan.clouds) this.#drawn.add(instance.cloud.planes.storage);
  }
}

function slowestFrameMs({ needs, layer }: ForecastPlan): number {
  return needs.visibleSplats * (SLOWEST_SPLAT_MS + SLOWEST_PIXEL_MS * layer.widthPx * layer.heightPx);
}
