import type { CloudSight, CloudStream } from '../clouds/cloud-stream.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import { cutErrorPx } from '../frame/level-cut.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';

/** A view's part in scenes that stream. */
export class ViewStreams {
  /** Those of the last frame. */
  #streams = new Set<CloudStream>();

  /**
   * Tells the streams of a frame's clouds how these are seen.
   *
   * @param last statistics of the last frame, by which a budget's error is known.
   */
  see(
    { clouds, detail, budget }: FramePlan,
    last: FrameStatistics | null,
    redraw: () => Promise<unknown>,
  ): void {
    const asked = cutErrorPx(detail, clouds);
    const reached = (budget && last?.cutErrorPx) || asked;
    const squaredShift = asked && reached ? (reached / asked) ** 2 : 1;
    const sights = new Map<CloudStream, CloudSight[]>();
    for (const { instance, cut, sides } of clouds) {
      const { stream } = instance.cloud;
      if (!stream || !cut) continue;
      sights.set(stream, [...(sights.get(stream) ?? []), { cut, sides, squaredShift }]);
    }
    for (const stream of this.#streams) if (!sights.has(stream)) stream.leave(this);
    this.#streams = new Set(sights.keys());
    for (const [stream, seen] of sights) stream.see(this, seen, redraw);
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
