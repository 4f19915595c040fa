import { type AccuracySettings, DILATION_PX2 } from '../accuracy/accuracy.ts';
import type { Camera, Projection } from '../camera/camera.ts';
import { type CloudView, cloudView } from '../camera/cloud-view.ts';
import { type FrustumSide, frustumSides, type SplatReach } from '../camera/frustum.ts';
import type { EffectPlace, EffectUse } from '../effects/effect.ts';
import { type EffectSet, effectSetOf, hasHook, packParameters } from '../effects/effect-set.ts';
import { CLOUD_EFFECTS, reachOf, usesOf } from '../effects/effects.ts';
import { InvalidArgumentError } from '../errors.ts';
import type { GpuFields, GpuValues } from '../layout/gpu-struct.ts';
import { identity4, type Mat4 } from '../math/mat4.ts';
import type { CloudFacts } from '../packing/cloud-facts.ts';
import type { ShDegree } from '../splats/splat-set.ts';
import type { CloudInstance } from './frame-request.ts';
import type { CloudShape, OmittableEffect } from './frame-shape.ts';

/** One effect of one cloud in one frame. */
export interface PlannedUse {
  readonly use: EffectUse;
  /** Contents of the effect's parameters; null where it has none. */
  readonly values: GpuValues<GpuFields> | null;
  /** Version of its selection; undefined where it takes none. */
  readonly selectionVersion: number | undefined;
}

/** One cloud of a frame. */
export interface CloudPlan {
  /** As the caller gave it, copied. */
  readonly instance: CloudInstance;
  /** Scene to world, float64, column-major. */
  readonly modelMatrix: Mat4;
  /** The effects that take part, in the order in which they act. */
  readonly uses: readonly PlannedUse[];
  readonly effects: EffectSet;
  /** The parameters of all of them, as shaders read them. */
  readonly parameters: Uint8Array;
  /** How far all effects together take splats from where they are stored. */
  readonly reach: SplatReach;
  readonly view: CloudView;
  /** The frustum in the cloud's space. */
  readonly sides: readonly FrustumSide[];
}

/**
 * The effects that take part in drawing a cloud.
 *
 * @throws InvalidArgumentError naming the cloud, for effects that do not go together.
 */
export function effectsOf(instance: CloudInstance): readonly EffectUse[] {
  try {
    return usesOf(instance);
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    throw new InvalidArgumentError(error.argument, `${instance.cloud.name}: ${error.message}`);
  }
}

/** The plan of one cloud of a frame. */
export function planCloud(
  instance: CloudInstance,
  camera: Camera,
  projection: Projection,
  { alphaCutoff }: AccuracySettings,
): CloudPlan {
  const { cloud } = instance;
  const modelMatrix = instance.modelMatrix ? new Float64Array(instance.modelMatrix) : identity4();
  const acting = effectsOf(instance);
  const place: EffectPlace = { modelMatrix, origin: cloud.origin, viewMatrix: camera.viewMatrix };
  const reach = reachOf(acting);
  const view = cloudView(camera.viewMatrix, modelMatrix, cloud.origin, projection.isOrthographic);
  const uses = acting.map((use) => ({
    use,
    values: ownValues(use.valuesAt(place)),
    selectionVersion: use.selection?.version,
  }));
  const effects = effectSetOf(acting);
  return {
    instance: { ...instance, ...(instance.modelMatrix && { modelMatrix }) },
    modelMatrix,
    uses,
    effects,
    parameters: packParameters(effects, uses),
    reach,
    view,
    sides: frustumSides(view, projection, alphaCutoff, DILATION_PX2, reach),
  };
}

/** A copy: values may be arrays of the caller's, who may change them later. */
function ownValues(values: GpuValues<GpuFields> | null): GpuValues<GpuFields> | null {
  if (!values) return null;
  const own = Object.entries(values).map(([name, value]) => [
    name,
    typeof value === 'number' ? value : Array.from(value),
  ]);
  return Object.fromEntries(own);
}

/** The shape of one cloud; it keeps no colours. */
export function cloudShape(
  { instance, effects }: CloudPlan,
  accuracy: AccuracySettings,
  omitted: readonly OmittableEffect[],
): CloudShape {
  const { cloud, shDegree = 3 } = instance;
  return {
    cloud,
    planes: cloud.pagesFor(accuracy),
    effects,
    shDegree: Math.min(accuracy.shDegree, shDegree, cloud.shDegree) as ShDegree,
    isIsotropic: !omitted.includes('isotropic') && isIsotropic(cloud.facts, effects),
    hasFaintSplats: !omitted.includes('faint-splats') && hasFaintSplats(cloud.facts, effects, accuracy),
    keepsColors: false,
  };
}

/** Effects of this package leave balls round; a caller's own may do anything. */
function isIsotropic(facts: CloudFacts, { effects }: EffectSet): boolean {
  return (
    facts.isIsotropic &&
    effects.every((effect) => effect.hooks.splat === undefined || CLOUD_EFFECTS.includes(effect))
  );
}

/** The step in which opacities are packed. */
const OPACITY_STEP = 1 / 65535;

/** Opacity hooks test by themselves the splats that they make fainter. */
function hasFaintSplats(facts: CloudFacts, effects: EffectSet, { alphaCutoff }: AccuracySettings): boolean {
  return hasHook(effects, 'splat') || facts.minOpacity - OPACITY_STEP < alphaCutoff;
}
