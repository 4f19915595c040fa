import { checkKind } from '../given.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import { permuteSplats } from '../packing/morton-order.ts';
import { givenSet } from '../splats/check-set.ts';
import type { SplatSet } from '../splats/splat-set.ts';

/**
 * The splats that are to stay, in their order and bit for bit as they are; there may be none.
 *
 * @param stays told of each splat by its index in the set, of which the row in its file is
 *   `set.fileIndices[index]`.
 */
export function filterSplats<Kind extends Harmonics>(
  set: SplatSet<Kind>,
  stays: (index: number) => boolean,
): SplatSet<Kind> {
  checkKind('stays', stays, 'a function');
  const kept = new Uint32Array(givenSet(set).count);
  let found = 0;
  for (let i = 0; i < set.count; i++) if (stays(i)) kept[found++] = i;
  return permuteSplats(set, kept.subarray(0, found));
}
