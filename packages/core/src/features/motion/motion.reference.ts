import type { EffectReference } from '../../reference/effects/effect-reference.ts';
import type { MotionOptions } from './motion.gpu.ts';
import { motionAt, timeWithin, turnedRotation } from './splat-motion.data.ts';

/** Changes splats that have a motion, and no others. */
export function reference(options: MotionOptions): EffectReference {
  const time = timeWithin(options);
  return {
    changeSplat(splat) {
      if (!splat.motion) return splat;
      const { position, opacity, rotation } = splat;
      const { displacement, share, turn } = motionAt(splat.motion, 0, time);
      return {
        ...splat,
        position: [
          position[0] + displacement[0],
          position[1] + displacement[1],
          position[2] + displacement[2],
        ],
        opacity: opacity * share,
        rotation: turnedRotation(rotation, turn),
      };
    },
  };
}
