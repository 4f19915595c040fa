import type { Vec3 } from '../data/math/mat4.ts';
import { dot, plus, unit } from '../data/math/vec3.ts';
import { CameraTrial, sharedViews, type Tried } from './camera-trial.ts';
import {
  type FoundUp,
  findSurfaces,
  findUp,
  knownUp,
  type Surfaces,
  turnedOver,
  USUAL_CONFIDENCE,
} from './find-up.ts';
import { log, sinCos } from './portable-math.ts';
import type { SplatSample } from './samples.ts';
import { type SceneDetail, sceneDetail } from './scene-detail.ts';
import type { FramingWishes, SceneFraming, SceneKind } from './scene-framing.ts';
import type { TrialShape } from './trial-view.ts';

/** A scene of which less is seen around it when one looks outwards is an object. */
const OBJECT_AROUND = 0.15;
/** A scene of which less is seen, sharp and full, when one looks outwards from within is not enclosed. */
const ENCLOSED_INSIDE = 0.1;
/** It is enclosed if the best camera within is so many times better than the best one outside. */
const ENCLOSED_BETTER = 1.2;

/**
 * Kind and up are found by pictures of this aspect ratio or wider ones, with a vertical field of view
 * of 50 degrees. A narrow window shows too little at once to tell a room from an object, and a wide
 * field of view shows surroundings all around a table.
 */
const LEAST_ASPECT = 4 / 3;
const [SIN, COS] = sinCos((50 * Math.PI) / 360);
const TRIAL_TANGENT = SIN / COS;

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
 * Frames the scene that `sample` was taken from; null if no splat of it can be seen. The same
 * arguments give the same result on every machine, bit for bit.
 */
export function frameSample(sample: SplatSample, wishes: FramingWishes): SceneFraming | null {
  const detail = sceneDetail(sample);
  if (!detail) return null;
  const { aspect, fovYDegrees } = wishes;
  const [sin, cos] = sinCos((fovYDegrees * Math.PI) / 360);
  const shape = { tangentX: (sin / cos) * aspect, tangentY: sin / cos };
  const chosen = chooseCamera(detail, shape, wishes);
  const { up, ground, confidence } = chosen.up;
  const { center, scale, reach } = detail;
  const world = (point: Vec3) => plus(center, point, scale);
  return {
    kind: chosen.kind,
    position: world(chosen.position),
    target: world(chosen.target),
    up,
    fovYDegrees,
    center,
    radius: scale * Math.max(1, reach),
    groundHeight: ground === null ? null : dot(center, up) + scale * ground,
    confidence: { up: confidence, kind: chosen.confidence },
  };
}

/** A camera, in units of the detail. */
interface ChosenCamera {
  readonly kind: SceneKind;
  readonly position: Vec3;
  readonly target: Vec3;
  readonly up: FoundUp;
  /** 0…1: how clearly the scene is of that kind. */
  readonly confidence: number;
}

/** Chooses the trial camera whose picture scores best: sharp, unhidden and within the frame. */
function chooseCamera(
  detail: SceneDetail,
  shape: TrialShape,
  { aspect, up, usualUp, kind: wantedKind }: FramingWishes,
): ChosenCamera {
  const views = sharedViews(detail, shape);
  const trialShape = {
    tangentX: TRIAL_TANGENT * Math.max(LEAST_ASPECT, aspect),
    tangentY: TRIAL_TANGENT,
  };
  const isAsked = shape.tangentX === trialShape.tangentX && shape.tangentY === TRIAL_TANGENT;
  const trialViews = isAsked ? views : sharedViews(detail, trialShape);
  const trialOf = (tried: FoundUp) => new CameraTrial(detail, tried.up, trialShape, trialViews);
  const surfaces = findSurfaces(detail);
  let found = up ? knownUp(detail, unit(up)) : findUp(detail, surfaces, usualUp, 'place');
  let trial = trialOf(found);
  const { around, inside } = trial.seenOutwards();
  const outsideKind = around < OBJECT_AROUND ? 'object' : 'surrounded';

  let best: Tried | null = null;
  let better = 0;
  if (inside >= ENCLOSED_INSIDE) {
    const outside = trial.best(outsideKind);
    const within = trial.best('enclosed');
    // Divided by the visible interest, so that the scores inside and outside compare.
    const score = within.score / Math.sqrt(within.picture.interesting);
    // NaN if nothing interesting is visible inside.
    better = (score * (1 - within.picture.empty)) / outside.score || 0;
    best = better > ENCLOSED_BETTER ? within : outside;
  }
  const isEnclosed = better > ENCLOSED_BETTER;
  const kind = wantedKind ?? (isEnclosed ? 'enclosed' : outsideKind);
  // Most flat splats of an upright room may lie above the rest, so only other scenes are turned over.
  if (!up && !isEnclosed) {
    if (outsideKind === 'object') found = uprightObject(detail, surfaces, usualUp, trialOf);
    else if (found.isCeiling) found = turnedOver(found);
    if (found.up.some((value, axis) => value !== trial.up[axis])) {
      trial = trialOf(found);
      best = null;
    }
  }
  if (!isAsked) trial = new CameraTrial(detail, found.up, shape, views);
  if (!best || wantedKind || !isAsked) best = trial.best(kind);
  return {
    kind,
    ...trial.refined(kind, best),
    up: found,
    confidence: Math.min(1, Math.abs(around / OBJECT_AROUND - 1), Math.abs(better / ENCLOSED_BETTER - 1)),
  };
}

/**
 * Finds up of an object, which need not stand on a floor: people take their pictures from above, so
 * that more of it is visible from there than from below.
 */
function uprightObject(
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
