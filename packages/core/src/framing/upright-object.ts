import type { Vec3 } from '../data/math/mat4.ts';
import type { CameraTrial } from './camera-trial.ts';
import { type FoundUp, findUp, type Surfaces, turnedOver, USUAL_CONFIDENCE } from './find-up.ts';
import { log } from './portable-math.ts';
import type { SceneDetail } from './scene-detail.ts';

/**
 * How many times more of an object must be visible from above than with the usual up to have another
 * one: a direction that surfaces tell more clearly than the usual up; one that they tell as clearly;
 * and one that they hardly tell.
 */
const MUCH_MORE = { clearer: 1.25, clear: 1.3, weak: 1.8 } as const;
/** The usual up is turned over if this many times more is visible from below. */
const TURNED_OVER = 1.2;
/** Least scores of surfaces that count as clear evidence, and as evidence at all. */
const TELLING = { clear: 7, weak: 4.5 } as const;

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
    if (excess > MUCH_MORE.clearer * usualExcess) return surely(up, excess / usualExcess);
  } else if (surfaces.bestScore > TELLING.weak) {
    const { up, excess } = upwards(findUp(detail, surfaces, usualUp, 'surfaces'), trialOf);
    const alternative = Math.max(usualExcess, 1 / usualExcess);
    const least = surfaces.bestScore > TELLING.clear ? MUCH_MORE.clear : MUCH_MORE.weak;
    if (excess > least * alternative) return surely(up, excess / alternative);
  }
  if (usualExcess * TURNED_OVER < 1) return surely(turnedOver(usual), 1 / usualExcess);
  const confidence = USUAL_CONFIDENCE + (1 - USUAL_CONFIDENCE) * doublings(usualExcess);
  return { ...usual, confidence: Math.min(1, Math.max(0, confidence)) };
}

/** An up of which so many times more is visible from above than of the next best. */
function surely(up: FoundUp, ratio: number): FoundUp {
  return { ...up, confidence: Math.min(1, doublings(ratio)) };
}

function doublings(ratio: number): number {
  return log(ratio) / Math.LN2;
}

/** Of a direction and its opposite, that from which more is visible. */
function upwards(
  found: FoundUp,
  trialOf: (up: FoundUp) => CameraTrial,
): { readonly up: FoundUp; readonly excess: number } {
  const excess = trialOf(found).excessFromAbove();
  return excess < 1 ? { up: turnedOver(found), excess: 1 / excess } : { up: found, excess };
}
