import type { Vec3 } from '../data/math/mat4.ts';
import { unit } from '../data/math/vec3.ts';
import { CameraTrial, sharedViews, type Tried } from './camera-trial.ts';
import { type FoundUp, findSurfaces, findUp, knownUp, turnedOver } from './find-up.ts';
import { sinCos } from './portable-math.ts';
import type { SceneDetail } from './scene-detail.ts';
import type { FramingWishes, SceneKind } from './scene-framing.ts';
import type { FrameShape } from './trial-view.ts';
import { uprightObject } from './upright-object.ts';

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

/** A camera, in units of the detail. */
export interface ChosenCamera {
  readonly kind: SceneKind;
  readonly position: Vec3;
  readonly target: Vec3;
  readonly up: FoundUp;
  /** 0…1: how clearly the scene is of that kind. */
  readonly confidence: number;
}

/** Chooses the trial camera whose picture scores best: sharp, unhidden and within the frame. */
export function chooseCamera(
  detail: SceneDetail,
  shape: FrameShape,
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
