import { InvalidArgumentError } from '../errors.ts';
import { checkKind, given } from '../given.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import { permuteSplats } from '../packing/morton-order.ts';
import { shown } from '../printable.ts';
import { givenSet } from '../splats/check-set.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { checkNumbers } from './check-numbers.ts';

/** A box in the scene's space, to which its sides belong. */
export interface CropBox {
  readonly min: Vec3;
  readonly max: Vec3;
  /** Whether splats in the box stay, or all others. Default: `inside`. */
  readonly keep?: 'inside' | 'outside';
}

/**
 * The splats whose centres are in a box, or outside of it, in their order and bit for bit as they
 * are.
 *
 * @throws InvalidArgumentError 'box' if it is none, or if nothing stays.
 * @example
 * const set = await readSplats('/garden.ply', { shPrecision: 'f32' });
 * const table = cropSplats(set, { min: [-1, -1, -1], max: [1, 1, 1] });
 * const bytes = await writeSplats(table, 'ply');
 */
export function cropSplats<Kind extends Harmonics>(set: SplatSet<Kind>, box: CropBox): SplatSet<Kind> {
  const cropped = cropPiece(set, box);
  if (cropped.count === 0) throw nothingLeft(set.count, box);
  return cropped;
}

/**
 * As `cropSplats`, but nothing may stay, as of a piece of a scene.
 *
 * @throws InvalidArgumentError 'box' if it is none.
 * @example
 * let count = 0;
 * await readSplatPieces(file, {}, async (piece) => {
 *   count += cropPiece(piece, { min: [-1, -1, -1], max: [1, 1, 1] }).count;
 * });
 */
export function cropPiece<Kind extends Harmonics>(set: SplatSet<Kind>, box: CropBox): SplatSet<Kind> {
  const { min, max, keep = 'inside' } = given(box, {}, 'box');
  for (const corner of [min, max]) checkNumbers('box', corner, 3);
  if (keep !== 'inside' && keep !== 'outside') {
    const message = `The box keeps ${shown(keep)}; it keeps "inside" or "outside".`;
    throw new InvalidArgumentError('box', message);
  }
  const flat = [0, 1, 2].find((axis) => min[axis] > max[axis]);
  if (flat !== undefined) {
    const message = `The least ${'xyz'[flat]} of the box, ${min[flat]}, is above the greatest, ${max[flat]}.`;
    throw new InvalidArgumentError('box', message);
  }
  const { positions, origin } = givenSet(set);
  return filterSplats(set, (i) => {
    let isInside = true;
    for (let axis = 0; axis < 3; axis++) {
      const value = positions[3 * i + axis] + origin[axis];
      isInside &&= value >= min[axis] && value <= max[axis];
    }
    return isInside === (keep === 'inside');
  });
}

/**
 * The error if a box leaves nothing of `count` splats.
 *
 * @hidden Shared with the packages beside this one.
 */
export function nothingLeft(count: number, { min, max, keep = 'inside' }: CropBox): InvalidArgumentError {
  const place = keep === 'inside' ? 'between' : 'outside of the box from';
  const end = keep === 'inside' ? 'and' : 'to';
  const message = `None of ${count} splats is ${place} ${min.join(', ')} ${end} ${max.join(', ')}.`;
  return new InvalidArgumentError('box', message);
}

/**
 * The splats that are to stay, in their order and bit for bit as they are; there may be none.
 *
 * @param stays called with the index of each splat in the set; `set.fileIndices[index]` is its row in
 *   the file.
 * @example
 * const set = await readSplats('/garden.ply');
 * const opaque = filterSplats(set, (i) => set.opacityLogits[i] > 0); // opacity above one half
 * const cloud = engine.add(opaque);
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
