import type { SplatSet } from '../data/splats/splat-set.ts';
import { MOTION_SLOT, MOTION_VALUES } from '../features/motion/splat-motion.data.ts';
import { type RandomSplatOptions, randomSplats } from './random-splats.ts';
import { seededRandom } from './seeded-random.ts';

/** Random splats that come, go, move by polynomials and turn between the times 0 and 1. */
export function movingSplats(options: RandomSplatOptions): SplatSet & { readonly motion: Float32Array } {
  const set = randomSplats(options);
  const random = seededRandom((options.seed ?? 1) + 1000);
  const motion = new Float32Array(set.count * MOTION_VALUES);
  for (let i = 0; i < set.count; i++) {
    const at = i * MOTION_VALUES;
    motion[at + MOTION_SLOT.time] = random();
    // Durations of 0.05 to 7: some are there all the time.
    motion[at + MOTION_SLOT.logDuration] = -3 + 5 * random();
    for (let k = 0; k < 9; k++) motion[at + MOTION_SLOT.velocity + k] = random() - 0.5;
    for (let k = 0; k < 4; k++) motion[at + MOTION_SLOT.turn + k] = random() - 0.5;
  }
  return { ...set, motion };
}
