import type { CloudSight, CloudStream } from '../clouds/cloud-stream.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import { cutErrorPx } from '../frame/level-cut.ts';

/** A view's part in scenes that stream. */
export class ViewStreams {
  /** Those of the last frame. */
  #streams = new Set<CloudStream>();
  /** What they were told last. */
  #reachedPx: number | null = null;

  /**
   * Tells the streams of a frame's clouds how these are seen.
   *
   * @param reachedPx error that a budget of this detail led to last; null before that is known, and
   *   then what the view needs is not known either.
   */
  see(plan: FramePlan, reachedPx: number | null, redraw: () => Promise<unknown>): void {
    this.#reachedPx = reachedPx;
    const sights = sightsOf(plan, reachedPx);
    for (const stream of this.#streams) if (!sights.has(stream)) stream.leave(this);
    this.#streams = new Set(sights.keys());
    const isUnknown = plan.budget && reachedPx === null;
    for (const [stream, seen] of sights) stream.see(this, isUnknown ? null : seen, redraw);
  }

  /** Tells them again if the budget of the frame that was told last leads to another error. */
  learn(plan: FramePlan, reachedPx: number | null): void {
    if (!plan.budget || reachedPx === null || reachedPx === this.#reachedPx) return;
    this.#reachedPx = reachedPx;
    for (const [stream, seen] of sightsOf(plan, reachedPx)) stream.learn(this, seen);
  }

  /** Tells them that a frame of what they were told has been submitted. */
  shown(): void {
    for (const stream of this.#streams) stream.shown();
  }

  /** Whether the last frame showed any. */
  get areThere(): boolean {
    return this.#streams.size > 0;
  }

  /** Settles when nothing is missing that there is room for; null if nothing is. */
  get complete(): Promise<unknown> | null {
    const waits = [...this.#streams].flatMap(({ complete }) => complete ?? []);
    return waits.length > 0 ? Promise.all(waits) : null;
  }

  /** Parts of the scenes that the view would draw if they were there. */
  get missing(): number {
    return [...this.#streams].reduce((sum, stream) => sum + stream.missingFor(this), 0);
  }

  /** What is on the GPU stays as it is until `until` settles. */
  hold(until: Promise<unknown>): void {
    for (const stream of this.#streams) stream.hold(until);
  }

  leave(): void {
    for (const stream of this.#streams) stream.leave(this);
    this.#streams.clear();
  }
}

/** How a frame sees the scenes that stream. */
function sightsOf(
  { clouds, detail, budget }: FramePlan,
  reachedPx: number | null,
): Map<CloudStream, CloudSight[]> {
  const askedPx = cutErrorPx(detail, clouds);
  const isFull = detail === 'full';
  const budgetShift = budget && askedPx && reachedPx ? (reachedPx / askedPx) ** 2 : 1;
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
