import type { CloudSight } from '../clouds/stream/cloud-sight.ts';
import type { CloudStream } from '../clouds/stream/cloud-stream.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import { cutErrorPx } from '../frame/plan/level-cut.ts';

/** The streams of the clouds that one view draws: tells each what the view sees. */
export class DrawnStreams {
  /** Streams of the last frame's clouds. */
  #streams = new Set<CloudStream>();
  /** The error that the current sights are based on, px; null if unknown. */
  #reachedPx: number | null = null;

  /**
   * Sets the sights of the streams in a frame.
   *
   * @param reachedPx error that the budget of this detail last led to; null if unknown.
   */
  setSights(plan: FramePlan, reachedPx: number | null, redraw: () => Promise<unknown>): void {
    this.#reachedPx = reachedPx;
    const sights = sightsOf(plan, reachedPx);
    for (const stream of this.#streams) if (!sights.has(stream)) stream.leave(this);
    this.#streams = new Set(sights.keys());
    for (const [stream, own] of sights) stream.setSights(this, own, redraw);
  }

  /** Updates the sights of the last frame if its budget turns out to lead to another error. */
  updateSights(plan: FramePlan, reachedPx: number | null): void {
    if (!plan.budget || reachedPx === null || reachedPx === this.#reachedPx) return;
    this.#reachedPx = reachedPx;
    for (const [stream, own] of sightsOf(plan, reachedPx)) stream.updateSights(this, own);
  }

  /** Call when the frame of the last sights has been submitted. */
  onFrame(): void {
    for (const stream of this.#streams) stream.onFrame();
  }

  /** Whether the last frame drew a streamed scene. */
  get areThere(): boolean {
    return this.#streams.size > 0;
  }

  /** Settles when all missing parts that fit have arrived; null if none is missing. */
  get complete(): Promise<unknown> | null {
    const waits = [...this.#streams].flatMap(({ complete }) => complete ?? []);
    return waits.length > 0 ? Promise.all(waits) : null;
  }

  /** Count of parts that the view would draw but that are not on the GPU. */
  get missing(): number {
    return [...this.#streams].reduce((sum, stream) => sum + stream.missingFor(this), 0);
  }

  /** Defers changes of all streams on the GPU until `until` settles. */
  deferUploads(until: Promise<unknown>): void {
    for (const stream of this.#streams) stream.deferUploads(until);
  }

  leave(): void {
    for (const stream of this.#streams) stream.leave(this);
    this.#streams.clear();
  }
}

/** Sights per stream: one per instance of its cloud in the frame. */
function sightsOf(
  { clouds, detail, budget }: FramePlan,
  reachedPx: number | null,
): Map<CloudStream, CloudSight[]> {
  const askedPx = cutErrorPx(detail, clouds);
  const isFull = detail === 'full';
  const knownShift = budget && askedPx && reachedPx ? (reachedPx / askedPx) ** 2 : 1;
  const budgetShift = budget && reachedPx === null ? null : knownShift;
  const squaredShift = isFull ? 0 : budgetShift;
  const limit = isFull
    ? { splats: Number.POSITIVE_INFINITY, isFinest: true }
    : budget && { splats: budget.splats, isFinest: budget.leastShift === 0 };
  const sights = new Map<CloudStream, CloudSight[]>();
  for (const { instance, sightCut, sides } of clouds) {
    const { stream } = instance.cloud;
    if (!stream || !sightCut) continue;
    const before = sights.get(stream) ?? [];
    sights.set(stream, [...before, { cut: sightCut, sides, squaredShift, budget: limit }]);
  }
  return sights;
}
