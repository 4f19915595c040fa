import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { StageTimings } from '../gpu/timing/frame-statistics.ts';

/**
 * An eighth of the two seconds after which Windows resets a driver. So a frame may take eight times
 * the forecast, for example after a jump of the camera. Also twice the longest frame time at which
 * a page still feels responsive.
 */
export const DEFAULT_SUBMISSION_BUDGET_MS = 250;

/**
 * Time per pixel of a quad or tile on the slowest devices, ms: software rendering on one or two
 * cores.
 */
const SLOWEST_PIXEL_MS = 2e-5;
/** Time there per splat that covers no pixel, ms. */
const SLOWEST_SPLAT_MS = 4e-3;

/**
 * The least of this many wall-clock times counts, because other work of the page or browser can
 * make a frame seem long.
 */
const WALL_CLOCK_FRAMES = 3;

export type ForecastPlan = Pick<FramePlan, 'needs' | 'layer'> & {
  readonly clouds: readonly { readonly instance: { readonly cloud: SplatCloud } }[];
};

/**
 * Predicts from measured frames whether a view's next frame fits into one submission. It does if
 * even the slowest device would finish in time with every splat covering the whole image. Otherwise
 * it does only if its clouds were drawn before and the last frame, scaled by the growth in work,
 * stays within the budget.
 */
export class SubmissionForecast {
  readonly #budgetMs: number;
  /** Storage of the planes of drawn clouds; previews of one load share it. */
  readonly #drawn = new WeakSet<object>();
  #elapsedMs = 0;
  /** Upper estimate of the last measured frame's time on the slowest device, ms. */
  #slowestMs = 0;
  #wallClocksMs: number[] = [];

  constructor(budgetMs: number) {
    this.#budgetMs = budgetMs;
  }

  /** Whether the frame may exceed the budget. */
  mayExceed(plan: ForecastPlan): boolean {
    const slowestMs = slowestFrameMs(plan);
    if (slowestMs <= this.#budgetMs) return false;
    if (plan.clouds.some(({ instance }) => !this.#drawn.has(instance.cloud.planes.storage))) return true;
    return this.#elapsedMs * Math.max(1, slowestMs / this.#slowestMs) > this.#budgetMs;
  }

  /** Adds the times of a frame in one submission. */
  take(plan: ForecastPlan, { totalMs, wallClockMs }: Pick<StageTimings, 'totalMs' | 'wallClockMs'>): void {
    this.#wallClocksMs = [...this.#wallClocksMs.slice(1 - WALL_CLOCK_FRAMES), wallClockMs];
    // Timestamps of some browsers are a hundred times too small.
    this.#take(plan, Math.max(totalMs, Math.min(...this.#wallClocksMs)));
  }

  /** Adds the time of a frame in several submissions, without pauses between them. */
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
