import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { given, wrongArgument } from '../../data/given.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { identity4, multiply4 } from '../../data/math/mat4.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { isDetached } from '../../data/printable.ts';

/**
 * Places in which a frame draws one cloud many times, with one upload and as many dispatches as for
 * one. Lists are copied by each frame, and may change between frames.
 */
export interface CloudInstances {
  /**
   * 16 numbers for each instance, column-major, read in float64: from the scene to the space that
   * `CloudInstance.modelMatrix` brings to the world. Their order is that in which equal depths are
   * drawn, blobs after splats.
   */
  readonly modelMatrices: ArrayLike<number>;
  /**
   * Factors of red, green and blue for each instance, sRGB-encoded, 0 or more, as the effect `tint`
   * has them, and besides it; default none.
   */
  readonly tints?: ArrayLike<number>;
  /** A factor of opacity for each instance, 0…1, besides `CloudInstance.opacity`; default none. */
  readonly opacities?: ArrayLike<number>;
}

/** Returns how many times a frame draws a cloud. */
export function countInstances({ instances }: { readonly instances?: CloudInstances }): number {
  return instances ? instances.modelMatrices.length / 16 : 1;
}

/** Returns the matrices of all places of a cloud, scene to world, float64, column-major. */
export function worldMatrices({
  modelMatrix = identity4(),
  instances,
}: {
  readonly modelMatrix?: ArrayLike<number>;
  readonly instances?: CloudInstances;
}): ArrayLike<number>[] {
  if (!instances) return [modelMatrix];
  const matrices = new Float64Array(instances.modelMatrices);
  return Array.from({ length: countInstances({ instances }) }, (_, i) => {
    const own = matrices.subarray(16 * i, 16 * i + 16);
    placed.set(own);
    return multiply4(modelMatrix, placed, own);
  });
}

/** Scratch memory. */
const placed = new Float64Array(16);

const LARGEST_F32 = 3.4028234663852886e38;

/**
 * Most splats of all instances of a cloud: with as many slots for blobs, and some, they are numbered
 * by 32 bits.
 */
const MOST_SPLATS = 2e9;

/**
 * @internal
 * @throws InvalidArgumentError naming the list, or `instances` for a cloud that streams and for too
 *   many splats.
 */
export function checkInstances(instances: CloudInstances, { pool, name, count: splats }: SplatCloud): void {
  const { modelMatrices, tints, opacities } = given(instances, {}, 'instances');
  if (pool) {
    const message = `${name} streams, and a cloud that streams has no instances; load it whole, or draw it once.`;
    throw new InvalidArgumentError('instances', message);
  }
  const count = modelMatrices?.length / 16;
  /** @param range least and most that a number may be. */
  const check = (
    argument: string,
    list: ArrayLike<number>,
    each: number,
    range: readonly [number, number],
    rule: string,
  ) => {
    let isValid = Number.isInteger(count) && !isDetached(list) && list.length === each * count;
    // NaN is in no range.
    for (let i = 0; isValid && i < list.length; i++)
      isValid = typeof list[i] === 'number' && list[i] >= range[0] && list[i] <= range[1];
    if (isValid) return;
    throw wrongArgument(`instances.${argument}`, list, `a list of ${each} ${rule} for each instance`, name);
  };
  const slots = CHUNK_SPLATS * chunkCountOf(splats) * count;
  if (slots > MOST_SPLATS) {
    const message = `${count} instances of ${name} have ${slots} splats, whole chunks of ${CHUNK_SPLATS} counted; a frame numbers ${MOST_SPLATS}.`;
    throw new InvalidArgumentError('instances', message);
  }
  const { MAX_VALUE } = Number;
  check('modelMatrices', modelMatrices, 16, [-MAX_VALUE, MAX_VALUE], 'finite numbers');
  if (tints) check('tints', tints, 3, [0, LARGEST_F32], 'finite numbers, 0 or more,');
  if (opacities) check('opacities', opacities, 1, [0, 1], 'number, 0…1,');
}
