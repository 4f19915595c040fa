import type { Vec3 } from '../math/mat4.ts';
import type { CameraTrial } from './camera-trial.ts';
import { type FoundUp, findUp, type Surfaces, turnedOver } from './find-up.ts';
import type { SceneDetail } from './scene-detail.ts';

/** How many times more of an object must be visible from above than with the usual up to have another up. */
const MUCH_MORE = {
  /** A direction that surfaces tell clearly. */
  surfaces: 1.15,
  /** One that they tell weakly. */
  weak: 1.8,
} as const;
/** The usual up is turned over if so many times more is visible from below. */
const MUCH_LESS = {
  /** Where most that lies flat lies above the rest. */
  ceiling: 1.2,
  alone: 1.4,
} as const;
/** Surfaces that tell less are not asked. */
const WEAK_SURFACES = 4.5;

/**
 * Finds up of an object, which need not stand on a floor: people take their pictures from above, so
 * that more of it is visible from there than from below.
 */
export function uprightObject(
  detail: SceneDetail,
  surfaces: Surfaces,
  usualUp: Vec3,
  trialOf: (up: FoundUp) => CameraTrial,
): FoundUp {
  const usual = findUp(detail, surfaces, usualUp, 'convention');
  const usualExcess = trialOf(usual).excessFromAbove();
  const clear = findUp(detail, surfaces, usualUp, 'object');
  if (clear.up !== usual.up) {
    const { up, excess } = upwards(clear, trialOf);
    if (excess > MUCH_MORE.surfaces * usualExcess) return up;
  } else if (surfaces.bestScore > WEAK_SURFACES) {
    const { up, excess } = upwards(findUp(detail, surfaces, usualUp, 'surfaces'), trialOf);
    if (excess > MUCH_MORE.weak * Math.max(usualExcess, 1 / usualExcess)) return up;
  }
  const least = usual.isCeiling ? MUCH_LESS.ceiling : MUCH_LESS.alone;
  return usualExcess * least < 1 ? turnedOver(usual) : usual;
}

/** Of a direction and its opposite, that from which more is visible. */
function upwards(
  found: FoundUp,
  trialOf: (up: FoundUp) => CameraTrial,
): { readonly up: FoundUp; readonly excess: number } {
  const excess = trialOf(found).excessFromAbove();
  return excess < 1 ? { up: turnedOver(found), excess: 1 / excess } : { up: found, excess };
}
