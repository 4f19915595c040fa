import type { CloudSight, CloudStream } from '../clouds/cloud-stream.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import { cutErrorPx } from '../frame/level-cut.ts';

/** A view's part in scenes that stream. */
export class ViewStreams {
  /** Those of the last frame. */
  #streams = new Set<CloudStream>();

  /**
   * Tells the streams of a frame's clouds how these are seen.
   *
   * @param reachedPx error that a budget of this detail led to last; null before that is known, and
   *   then what the view needs is not known either.
   */
  see({ clouds, detail, budget }: FramePlan, reachedPx: number | null, redraw: () => Promise<unknown>): void {
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
      sights.set(stream, [
        ...(sights.get(stream) ?? []),
        { cut: sightCut, sides, squaredShift, budget: limit },
      ]);
    }
    for (const stream of this.#streams) if (!sights.has(stream)) stream.leave(this);
    this.#streams = new Set(sights.keys());
    const isUnknown = budget && reachedPx === null;
    for (const [stream, seen] of sights) stream.see(this, isUnknown ? null : seen, redraw);
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
    return [...this.#streams].reduce((sum, stream) => sum + stream.report().missingBricks, 0);
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
