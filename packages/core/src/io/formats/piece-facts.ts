import type { Vec3 } from '../../data/math/mat4.ts';
import { emptyBounds } from '../../data/packing/center-bounds.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { chooseOrigin } from '../../data/packing/origin.ts';
import type { DropCounts, DropReason, FileFacts, ShDegree, SplatSet } from '../../data/splats/splat-set.ts';

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

  add({ count, positions, origin, harmonics, dropped, isAntialiased, fileFacts }: SplatSet<Harmonics>): void {
    this.count += count;
    this.shDegree = harmonics.degree;
    this.isAntialiased = isAntialiased;
    this.fileFacts = fileFacts;
    for (const [reason, drops] of Object.entries(dropped) as [DropReason, number][])
      this.dropped[reason] = (this.dropped[reason] ?? 0) + drops;
    const { min, max } = this.bounds;
    for (let i = 0; i < 3 * count; i++) {
      const axis = i % 3;
      const value = origin[axis] + positions[i];
      if (value < min[axis]) min[axis] = value;
      if (value > max[axis]) max[axis] = value;
    }
  }

  /** Point that positions of all pieces together would be relative to. */
  get origin(): Vec3 {
    return chooseOrigin(this.bounds.min, this.bounds.max);
  }
}
