import { type AccuracySettings, DILATION_PX2 } from '../data/accuracy/accuracy.ts';
import type { Camera, Projection } from '../data/camera/camera.ts';
import { type CloudView, cloudView } from '../data/camera/cloud-view.ts';
import { type FrustumSide, frustumSides, type SplatReach } from '../data/camera/frustum.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import type { GpuFields, GpuValues } from '../data/layout/gpu-struct.ts';
import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { identity4, type Mat4 } from '../data/math/mat4.ts';
import type { CloudFacts } from '../data/packing/cloud-facts.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import type { EffectPlace, EffectUse } from '../gpu/effects/effect.ts';
import { type EffectSet, effectSetOf, packParameters } from '../gpu/effects/effect-set.ts';
import { CLOUD_EFFECTS, reachOf, usesOf } from '../gpu/effects/effect-uses.ts';
import { isFiniteF32 } from '../gpu/effects/option-checks.ts';
import type { FixedDetail } from './detail.ts';
import type { CloudInstance } from './frame-request.ts';
import type { CloudShape } from './frame-shape.ts';
import { FINEST_CUT, type LevelCut, levelCut, reasonInFull } from './level-cut.ts';

/** One effect of one cloud in one frame. */
export interface PlannedUse {
  readonly use: EffectUse;
  /** Values of the effect's parameters; null if it has none. */
  readonly values: GpuValues<GpuFields> | null;
  /** Version of the effect's selection; undefined without one. */
  readonly selectionVersion: number | undefined;
}

/** One cloud of a frame. */
export interface CloudPlan {
  /** Copy of the caller's instance. */
  readonly instance: CloudInstance;
  /** The cloud's, which edits change. */
  readonly version: number;
  /** Scene to world, float64, column-major. */
  readonly modelMatrix: Mat4;
  /** Effects that the cloud is drawn with, in the order in which they act. */
  readonly uses: readonly PlannedUse[];
  readonly effects: EffectSet;
  /** Packed parameters of all effects, as shaders read them. */
  readonly parameters: Uint8Array;
  /** How far all effects together move splats, and how much they enlarge them. */
  readonly reach: SplatReach;
  readonly view: CloudView;
  /** Sides of the frustum in the cloud's space. */
  readonly sides: readonly FrustumSide[];
  /** Why all splats are drawn: see `reasonInFull`. */
  readonly inFull: string | null;
  /** The cut through the cloud's levels; null where all splats are drawn, or levels are missing. */
  readonly cut: LevelCut | null;
  /** By which a stream ranks what is missing: the cut, or that of one pixel where no error is allowed. */
  readonly sightCut: LevelCut | null;
  /** Whether the cut is refined, so that edited and selected splats are drawn one by one. */
  readonly isTouched: boolean;
}

/**
 * Returns the effects that a cloud is drawn with.
 *
 * @throws InvalidArgumentError naming the cloud, if its effects cannot be combined.
 */
export function effectsOf(instance: CloudInstance): readonly EffectUse[] {
  try {
    return usesOf(instance);
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    throw new InvalidArgumentError(error.argument, `${instance.cloud.name}: ${error.message}`);
  }
}

/** Plans one cloud of a frame. */
export function planCloud(
  instance: CloudInstance,
  camera: Camera,
  projection: Projection,
  accuracy: AccuracySettings,
  detail: FixedDetail = 'full',
): CloudPlan {
  const { cloud } = instance;
  const modelMatrix = instance.modelMatrix ? new Float64Array(instance.modelMatrix) : identity4();
  const acting = effectsOf(instance);
  const place: EffectPlace = { modelMatrix, origin: cloud.origin, viewMatrix: camera.viewMatrix };
  const reach = reachOf(acting);
  const view = cloudView(camera.viewMatrix, modelMatrix, cloud.origin, projection.isOrthographic);
  if (![...view.linear, ...view.translation].every(isFiniteF32)) {
    const message = `${cloud.name}: its place in view space exceeds float32.`;
    throw new InvalidArgumentError('modelMatrix', message);
  }
  const uses = acting.map((use) => ({
    use,
    values: ownValues(use.valuesAt(place)),
    selectionVersion: use.selection?.version,
  }));
  const effects = effectSetOf(acting);
  const inFull = reasonInFull(cloud, detail, view, accuracy);
  const found = inFull === null ? levelCut(cloud.levels, detail, view, projection, reach) : null;
  const cut = found ?? (cloud.pool ? FINEST_CUT : null);
  const sightCut = found ?? (cloud.pool && levelCut(cloud.levels, {}, view, projection, reach)) ?? cut;
  return {
    instance: {
      ...instance,
      ...(instance.modelMatrix && { modelMatrix }),
      ...(instance.effects && { effects: [...instance.effects] }),
    },
    version: cloud.version,
    modelMatrix,
    uses,
    effects,
    parameters: packParameters(effects, uses),
    reach,
    view,
    sides: frustumSides(
      view,
      projection,
      accuracy.alphaCutoff,
      DILATION_PX2,
      reach,
      cut ? LEVEL_CONSTANTS.MOST_OPACITY : 1,
    ),
    inFull,
    cut,
    sightCut,
    isTouched:
      cut !== null &&
      cloud.levels?.refinement != null &&
      (!!cloud.editing?.touched.count || uses.some(showsSelection)),
  };
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
    shDegree: Math.min(shDegree, cloud.shDegree) as ShDegree,
    // Balls merge to blobs that are none.
    isIsotropic: mayBeIsotropic && !cut && isIsotropic(cloud.facts, effects),
  };
}

/** This package's effects keep spheres round; callers' effects might not. */
function isIsotropic(facts: CloudFacts, { effects }: EffectSet): boolean {
  return (
    facts.isIsotropic &&
    effects.every((effect) => effect.hooks.splat === undefined || CLOUD_EFFECTS.includes(effect))
  );
}
