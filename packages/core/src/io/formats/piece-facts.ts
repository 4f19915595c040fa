import type { Vec3 } from '../../data/math/mat4.ts';
import { centerBounds, emptyBounds } from '../../data/packing/center-bounds.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { chooseOrigin } from '../../data/packing/origin.ts';
import { PositionSample } from '../../data/packing/position-sample.ts';
import {
  addDrops,
  type DropCounts,
  type FileFacts,
  type ShDegree,
  type SplatSet,
} from '../../data/splats/splat-set.ts';

/** Facts about the splats of a file, of which some pieces have come. */
export class PieceFacts {
  count = 0;
  shDegree: ShDegree = 0;
  /** See `SplatColumns`. */
  isAntialiased: boolean | undefined;
  fileFacts: FileFacts | undefined;
  readonly dropped: DropCounts = {};
  /** Bounds of centres in the scene's space, ±Infinity without splats. */
  readonly bounds = emptyBounds();
  readonly #sample = new PositionSample();
  #isWide = false;

  add({ count, positions, origin, harmonics, dropped, isAntialiased, fileFacts }: SplatSet<Harmonics>): void {
    this.#sample.addAll(positions, count, origin, this.count);
    this.#isWide ||= origin.some((value) => value !== 0);
    this.count += count;
    this.shDegree = harmonics.degree;
    this.isAntialiased = isAntialiased;
    this.fileFacts = fileFacts;
    addDrops(this.dropped, dropped);
    const { min, max } = centerBounds(positions, count);
    for (let axis = 0; axis < 3; axis++) {
      this.bounds.min[axis] = Math.min(this.bounds.min[axis], origin[axis] + min[axis]);
      this.bounds.max[axis] = Math.max(this.bounds.max[axis], origin[axis] + max[axis]);
    }
  }

  /** Point that positions of all pieces together would be relative to. */
  get origin(): Vec3 {
    return chooseOrigin(this.#sample.axes, this.bounds, this.#isWide);
  }
}
