import { filterSplats } from '../../data/editing/crop-splats.ts';
import { wrongArgument } from '../../data/given.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { givenSet } from '../../data/splats/check-set.ts';
import { logitOfShare, opacityOf } from '../../data/splats/color-values.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { MOTION_VALUES, motionAt, turnedRotation } from './splat-motion.data.ts';

/** No accuracy setting draws a splat of a lower opacity. */
const LEAST_OPACITY = 1 / 4096;

/**
 * Freezes a moving scene at a time, and leaves out splats that are invisible then. Sets that stand
 * still are returned as they are.
 *
 * @param time in the unit of the file; trained scenes have 0 to 1. Motions are continued beyond.
 * @throws InvalidArgumentError 'time' unless it is a finite number; 'set' if it is none.
 * @example
 * const set = await readSplats('/dancer.ply', { shPrecision: 'f32' });
 * const bytes = await writeSplats(splatsAt(set, 0.5), 'spz');
 */
export function splatsAt<Kind extends Harmonics>(set: SplatSet<Kind>, time: number): SplatSet<Kind> {
  if (!Number.isFinite(time)) throw wrongArgument('time', time, 'a finite number');
  const { motion, ...still } = givenSet(set);
  if (!motion) return set;
  const positions = set.positions.slice();
  const rotations = set.rotations.slice();
  const opacityLogits = set.opacityLogits.slice();
  for (let i = 0; i < set.count; i++) {
    const { displacement, share, turn } = motionAt(motion, i * MOTION_VALUES, time);
    for (let axis = 0; axis < 3; axis++) positions[3 * i + axis] += displacement[axis];
    rotations.set(turnedRotation(rotations.subarray(4 * i, 4 * i + 4), turn), 4 * i);
    opacityLogits[i] = logitOfShare(opacityLogits[i], Math.log(share));
  }
  const frozen = { ...still, positions, rotations, opacityLogits };
  return filterSplats(frozen, (i) => opacityOf(opacityLogits[i]) >= LEAST_OPACITY);
}
