import { floatStep } from '../../../data/math/float-step.ts';
import { PositionSample, splatSize } from '../../../data/packing/position-sample.ts';
import type { SplatColumns } from '../../../data/splats/splat-set.ts';

/** A float32 step is too coarse if it exceeds this fraction of the splat's size, or of the median size. */
const MOST_STEP = 1 / 2;
/** Least fraction of affected splats for a note: fewer are likely strays. */
const TOLD_SHARE = 0.05;

/**
 * Counts splats whose positions in float32 are too coarse for their sizes. This happens in parts of
 * a scene that lie far from the origin.
 */
export class CoarsePlaces {
  #splats = 0;
  #coarse = 0;
  /** Longest step and the median splat size next to it, in scene units. */
  #worst = { step: 0, medianSize: 0 };

  /** @param isRounded whether float32 rounds the file's coordinate, given its index in `positions`. */
  add(
    { count, positions, logScales }: Pick<SplatColumns, 'count' | 'positions' | 'logScales'>,
    isRounded: (at: number) => boolean,
  ): void {
    this.#splats += count;
    const sample = new PositionSample();
    sample.addAll(positions, count, undefined, 0, logScales);
    const { medianSize } = sample;
    let farthest = 0;
    for (let at = 0; at < 3 * count; at++) farthest = Math.max(farthest, Math.abs(positions[at]));
    // Usual case: even the farthest splat has a fine enough step.
    if (floatStep(farthest) <= MOST_STEP * medianSize) return;
    for (let i = 0; i < count; i++) {
      let step = 0;
      for (let at = 3 * i; at < 3 * i + 3; at++)
        if (isRounded(at)) step = Math.max(step, floatStep(positions[at]));
      if (step <= MOST_STEP * Math.max(medianSize, splatSize(logScales, 3 * i))) continue;
      this.#coarse++;
      if (step > this.#worst.step) this.#worst = { step, medianSize };
    }
  }

  /** A note for `FileFacts`; undefined if too few splats are affected. */
  get note(): string | undefined {
    if (this.#coarse <= TOLD_SHARE * this.#splats) return undefined;
    const [coarse, splats] = [this.#coarse, this.#splats].map((count) => count.toLocaleString('en'));
    const { step, medianSize } = this.#worst;
    const [longest, size] = [step, medianSize].map((value) => Number(value.toPrecision(2)));
    return `Its parts lie too far apart for float32: ${coarse} of ${splats} splats are placed in steps of up to ${longest}, and the splats' median size is ${size}. Export each part about its own origin.`;
  }
}
