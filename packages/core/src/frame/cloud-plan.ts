import { writerOf } from '../clouds/cloud-feature.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import type { Camera, Projection } from '../data/camera/camera.ts';
import { type CloudView, cloudView } from '../data/camera/cloud-view.ts';
import { type FrustumSide, frustumSides, type SplatReach } from '../data/camera/frustum.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import type { GpuFields, GpuValues } from '../data/layout/gpu-struct.ts';
import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { identity4, type Mat4 } from '../data/math/mat4.ts';
import type { CloudFacts } from '../data/packing/cloud-facts.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import type { BoundResource, EffectPlace, EffectUse, SplatEffect } from '../gpu/effects/effect.ts';
import { placeInList } from '../gpu/effects/effect-list.ts';
import { type EffectSet, effectSetOf, packParameters } from '../gpu/effects/effect-set.ts';
import { dilationOf, reachOf, usesOf } from '../gpu/effects/effect-uses.ts';
import { opacity } from '../gpu/effects/opacity/opacity.ts';
import { isFiniteF32 } from '../gpu/effects/option-checks.ts';
import { tint } from '../gpu/effects/tint/tint.ts';
import { type CloudInstances, countInstances, worldMatrices } from './cloud-instances.ts';
import type { FixedDetail } from './detail.ts';
import type { CloudInstance } from './frame-request.ts';
import type { CloudShape } from './frame-shape.ts';
import { FINEST_CUT, type LevelCut, levelCut, nearestDepth, reasonInFull } from './level-cut.ts';

/** One effect of one cloud in one frame. */
export interface PlannedUse {
  readonly use: EffectUse;
  /** Values of the effect's parameters; null if it has none. */
  readonly values: GpuValues<GpuFields> | null;
  /** Version of the effect's selection; undefined without one. */
  readonly selectionVersion: number | undefined;
  /** Textures and buffers of the effect's own. */
  readonly resources: readonly BoundResource[];
}

const NO_RESOURCES: readonly BoundResource[] = [];

/** Effects, and sets of effects, that cannot be drawn with, and why. */
export type EffectFaults = WeakMap<SplatEffect | EffectSet, Error>;

/** An effect of one cloud that is not drawn, because of an error that is no argument's. */
interface LeftOut {
  readonly effect: SplatEffect;
  readonly error: Error;
}

/** The effects of one cloud that can be drawn, and the others. */
interface SoundEffects {
  readonly acting: readonly Pick<PlannedUse, 'use' | 'resources'>[];
  readonly leftOut: readonly LeftOut[];
  readonly effects: EffectSet;
}

/** One placement of a cloud: its view, frustum planes and LOD cut. */
export interface CloudPlace {
  readonly view: CloudView;
  /** Frustum planes in the cloud's space. */
  readonly sides: readonly FrustumSide[];
  /** LOD cut of the cloud; null if all splats are drawn or the cloud has no levels. */
  readonly cut: LevelCut | null;
}

/** One cloud of a frame. */
export interface CloudPlan extends CloudPlace {
  /** Copy of the caller's instance. */
  readonly instance: CloudInstance;
  /** The cloud's, which edits change. */
  readonly version: number;
  /** Scene to world, float64, column-major. */
  readonly modelMatrix: Mat4;
  /** Effects that the cloud is drawn with, in the order in which they act. */
  readonly uses: readonly PlannedUse[];
  readonly effects: EffectSet;
  readonly leftOut: readonly LeftOut[];
  /** Packed parameters of all effects, as shaders read them; of instances, one after another. */
  readonly parameters: Uint8Array;
  /** How far all effects together move splats, and how much they enlarge them. */
  readonly reach: SplatReach;
  /** Variance that is added to both screen axes of every splat, px². */
  readonly dilationPx2: number;
  /** Places of the cloud's instances; null: the cloud is drawn once, at its own. */
  readonly places: readonly CloudPlace[] | null;
  /** Why all splats are drawn: see `reasonInFull`. */
  readonly inFull: string | null;
  /** Cut by which a stream ranks missing parts: `cut`, or a cut of one pixel if no error is allowed. */
  readonly sightCut: LevelCut | null;
  /** Whether the cut is refined, so that edited and selected splats are drawn one by one. */
  readonly isTouched: boolean;
}

/**
 * Returns the effects that a cloud is drawn with.
 *
 * @throws InvalidArgumentError naming the cloud, if its effects cannot be combined.
 */
function effectsOf(instance: CloudInstance): readonly EffectUse[] {
  try {
    return usesOf(instance);
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    throw new InvalidArgumentError(error.argument, `${instance.cloud.name}: ${error.message}`);
  }
}

/**
 * Checks the effects of a cloud that is not planned.
 *
 * @throws InvalidArgumentError
 */
export function checkEffects(instance: CloudInstance): void {
  soundEffects(instance, new WeakMap());
}

/** @throws InvalidArgumentError */
function soundEffects(instance: CloudInstance, faults: EffectFaults): SoundEffects {
  const { cloud } = instance;
  const asked = effectsOf(instance);
  const leftOut: LeftOut[] = [];
  const sound = asked.flatMap((use) => {
    const { effect } = use;
    const resources = effect.resources?.on(use, asked, cloud) ?? NO_RESOURCES;
    const error = faults.get(effect) ?? effect.resources?.refusal(resources, cloud.device);
    if (!error) return { use, resources };
    leftOut.push({ effect, error });
    return [];
  });
  // Some sets cannot be drawn with, and nothing tells because of which effect. Motion is the first.
  const motion = cloud.timeRange ? sound.slice(0, 1) : [];
  for (const acting of [sound, motion, []]) {
    const effects = effectSetOf(acting.map(({ use }) => use));
    const error = faults.get(effects);
    if (!error) return { acting, leftOut, effects };
    leftOut.push(...acting.map(({ use: { effect } }) => ({ effect, error })));
  }
  throw new RangeError('A set without effects cannot have a fault.');
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
  const { acting, leftOut, effects } = soundEffects(instance, faults);
  const drawn = acting.map(({ use }) => use);
  const effectPlace = (matrix: ArrayLike<number>): EffectPlace => ({
    modelMatrix: matrix,
    origin: cloud.origin,
    viewMatrix: camera.viewMatrix,
    projection,
  });
  const instances = instance.instances && copiedInstances(instance.instances);
  const matrices = instances && worldMatrices({ modelMatrix, instances });
  const reach = reachOf(drawn, matrices ?? [modelMatrix]);
  const dilationPx2 = dilationOf(drawn);
  const view = viewOf(cloud, modelMatrix, camera, projection);
  const uses = acting.map(({ use, resources }) => ({
    use,
    values: ownValues(use.valuesAt(effectPlace(modelMatrix))),
    selectionVersion: use.selection?.version,
    resources,
  }));
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
    uses,
    effects,
    leftOut,
    parameters: packParameters(
      effects,
      matrices && instances
        ? matrices.map((matrix, i) => valuesOfInstance(uses, effectPlace(matrix), instances, i))
        : [uses],
    ),
    reach,
    dilationPx2,
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

/** Values of a cloud's effects for one of its instances, with its own opacity and tint. */
function valuesOfInstance(
  uses: readonly PlannedUse[],
  place: EffectPlace,
  { opacities, tints }: CloudInstances,
  i: number,
): Pick<PlannedUse, 'use' | 'values'>[] {
  return uses.map(({ use }) => {
    const values = use.valuesAt(place);
    if (opacities && use.effect === opacity.effect)
      return { use, values: { factor: (values!.factor as number) * opacities[i] } };
    if (tints && use.effect === tint.effect) {
      const color = Array.from(
        values!.color as ArrayLike<number>,
        (factor, at) => factor * tints[3 * i + at],
      );
      return { use, values: { color } };
    }
    return { use, values };
  });
}

/** Whether an effect shows a selection of splats. */
export function showsSelection({ selectionVersion }: PlannedUse): boolean {
  return selectionVersion !== undefined;
}

/** Copies values: callers may change their arrays later. */
function ownValues(values: GpuValues<GpuFields> | null): GpuValues<GpuFields> | null {
  if (!values) return null;
  const own = Object.entries(values).map(([name, value]) => [
    name,
    typeof value === 'number' ? value : Array.from(value),
  ]);
  return Object.fromEntries(own);
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
function isIsotropic(facts: CloudFacts, { parts }: EffectSet): boolean {
  return (
    facts.isIsotropic &&
    parts.every(({ effect, hooks }) => hooks.splat === undefined || placeInList(effect) >= 0)
  );
}
