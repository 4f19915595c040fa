import { writerOf } from '../../clouds/cloud-feature.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import type { AccuracySettings } from '../../data/accuracy/accuracy.ts';
import type { Camera, Projection } from '../../data/camera/camera.ts';
import { type CloudView, cloudView } from '../../data/camera/cloud-view.ts';
import { type FrustumSide, frustumSides } from '../../data/camera/frustum.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { identity4, type Mat4 } from '../../data/math/mat4.ts';
import type { CloudFacts } from '../../data/packing/cloud-facts.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import {
  type CloudEffects,
  cloudEffects,
  type EffectFaults,
  showsSelection,
} from '../../gpu/effects/cloud-effects.ts';
import type { EffectPlace } from '../../gpu/effects/effect.ts';
import { placeInList } from '../../gpu/effects/effect-list.ts';
import type { EffectSet } from '../../gpu/effects/effect-set.ts';
import { isFiniteF32 } from '../../gpu/effects/option-checks.ts';
import { type CloudInstances, countInstances, worldMatrices } from './cloud-instances.ts';
import type { FixedDetail } from './detail.ts';
import type { CloudInstance } from './frame-request.ts';
import type { CloudShape } from './frame-shape.ts';
import { FINEST_CUT, type LevelCut, levelCut, nearestDepth, reasonInFull } from './level-cut.ts';

/** One placement of a cloud: its view, frustum planes and LOD cut. */
export interface CloudPlace {
  readonly view: CloudView;
  /** Frustum planes in the cloud's space. */
  readonly sides: readonly FrustumSide[];
  /** LOD cut of the cloud; null if all splats are drawn or the cloud has no levels. */
  readonly cut: LevelCut | null;
}

/** One cloud of a frame. */
export interface CloudPlan extends CloudPlace, CloudEffects {
  /** Copy of the caller's instance. */
  readonly instance: CloudInstance;
  /** The cloud's, which edits change. */
  readonly version: number;
  /** Scene to world, float64, column-major. */
  readonly modelMatrix: Mat4;
  /** Places of the cloud's instances; null: the cloud is drawn once, at its own. */
  readonly places: readonly CloudPlace[] | null;
  /** Why all splats are drawn: see `reasonInFull`. */
  readonly inFull: string | null;
  /** Cut by which a stream ranks missing parts: `cut`, or a cut of one pixel if no error is allowed. */
  readonly sightCut: LevelCut | null;
  /** Whether the cut is refined, so that edited and selected splats are drawn one by one. */
  readonly isTouched: boolean;
}

/** Plans one cloud of a frame. */
export function planCloud(
  instance: CloudInstance,
  camera: Camera,
  projection: Projection,
  accuracy: AccuracySettings,
  detail: FixedDetail = 'full',
  faults: EffectFaults = new WeakMap(),
): CloudPlan {
  const { cloud } = instance;
  const modelMatrix = instance.modelMatrix ? new Float64Array(instance.modelMatrix) : identity4();
  const effectPlace = (matrix: ArrayLike<number>): EffectPlace => ({
    modelMatrix: matrix,
    origin: cloud.origin,
    viewMatrix: camera.viewMatrix,
    projection,
  });
  const instances = instance.instances && copiedInstances(instance.instances);
  const matrices = instances && worldMatrices({ modelMatrix, instances });
  const acting = cloudEffects(instance, faults, matrices ?? null, modelMatrix, effectPlace);
  const { uses, reach, dilationPx2 } = acting;
  const view = viewOf(cloud, modelMatrix, camera, projection);
  const inFull = reasonInFull(instance, detail, view, accuracy);
  const cutAt = (seen: CloudView) => {
    if (inFull !== null) return null;
    const depth = seen.inverse ? 0 : nearestDepth(cloud, seen);
    return levelCut(cloud.levels, detail, seen, projection, reach, depth);
  };
  const found = cutAt(view);
  const cut = found ?? (cloud.pool ? FINEST_CUT : null);
  const sightCut = found ?? (cloud.pool && levelCut(cloud.levels, {}, view, projection, reach)) ?? cut;
  const sidesOf = (seen: CloudView) =>
    frustumSides(
      seen,
      projection,
      accuracy.alphaCutoff,
      dilationPx2,
      reach,
      cut ? LEVEL_CONSTANTS.MOST_OPACITY : 1,
    );
  return {
    instance: {
      ...instance,
      ...(instances && { instances }),
      ...(instance.modelMatrix && { modelMatrix }),
      ...(instance.effects && { effects: [...instance.effects] }),
    },
    version: cloud.version,
    modelMatrix,
    ...acting,
    view,
    sides: sidesOf(view),
    places:
      matrices?.map((matrix) => {
        const seen = viewOf(cloud, matrix, camera, projection);
        return { view: seen, sides: sidesOf(seen), cut: cut && cutAt(seen) };
      }) ?? null,
    inFull,
    cut,
    sightCut,
    isTouched:
      cut !== null &&
      cloud.levels?.refinement != null &&
      (!!writerOf(cloud)?.touched?.count || uses.some(showsSelection)),
  };
}

/** @throws InvalidArgumentError naming the cloud, if shaders cannot compute its view coordinates. */
function viewOf(
  cloud: SplatCloud,
  modelMatrix: ArrayLike<number>,
  camera: Camera,
  projection: Projection,
): CloudView {
  const view = cloudView(camera.viewMatrix, modelMatrix, cloud.origin, projection.isOrthographic);
  if (view.linear.every(isFiniteF32) && view.translation.every(isFiniteF32)) return view;
  const message = `${cloud.name}: its place in view space exceeds float32.`;
  throw new InvalidArgumentError('modelMatrix', message);
}

/** Callers may write into theirs. */
function copiedInstances({ modelMatrices, tints, opacities }: CloudInstances): CloudInstances {
  return {
    modelMatrices: copied(modelMatrices),
    ...(tints && { tints: copied(tints) }),
    ...(opacities && { opacities: copied(opacities) }),
  };
}

/** Float32Arrays stay such, which three has: conversion is slow. */
function copied(list: ArrayLike<number>): ArrayLike<number> {
  return list instanceof Float32Array ? list.slice() : new Float64Array(list);
}

/** Returns the shape of one cloud. */
export function cloudShape(
  { instance, effects, cut, isTouched }: CloudPlan,
  accuracy: AccuracySettings,
  mayBeIsotropic: boolean,
): CloudShape {
  const { cloud, shDegree = 3 } = instance;
  return {
    cloud,
    planes: cloud.pagesFor(accuracy),
    levels: cut && cloud.levels,
    isTouched,
    effects,
    instanceCount: instance.instances ? countInstances(instance) : null,
    shDegree: Math.min(shDegree, cloud.shDegree) as ShDegree,
    // Balls merge to blobs that are none.
    isIsotropic: mayBeIsotropic && !cut && isIsotropic(cloud.facts, effects),
  };
}

/** This package's effects keep spheres round; callers' effects might not. */
function isIsotropic(facts: CloudFacts, { linked }: EffectSet): boolean {
  return (
    facts.isIsotropic &&
    linked.every(({ effect, hooks }) => hooks.splat === undefined || placeInList(effect) >= 0)
  );
}
