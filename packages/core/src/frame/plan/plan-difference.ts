import type { Camera } from '../../data/camera/camera.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import type { GpuFields, GpuValues } from '../../data/layout/gpu-struct.ts';
import { type PlannedUse, showsSelection } from '../../gpu/effects/cloud-effects.ts';
import { changesOrder } from '../../gpu/effects/effect-set.ts';
import type { CloudInstances } from './cloud-instances.ts';
import type { CloudPlan } from './cloud-plan.ts';
import type { FramePlan } from './frame-plan.ts';
import type { LevelCut } from './level-cut.ts';

/** The parts of plans that tell whether they draw the same splats in the same order. */
type PlannedOrder = Pick<FramePlan, 'request' | 'camera' | 'clouds' | 'shape' | 'budget'>;

/** Whether both frames show the same splats in the same places and order. Their rasterisers may differ. */
export function isSameOrder(a: PlannedOrder, b: PlannedOrder): boolean {
  return isSameCamera(a.camera, b.camera) && showsSameSplats(a, b);
}

/** Whether cameras see the same, at the same size. */
function isSameCamera(a: Camera, b: Camera): boolean {
  return (
    isSameNumber(a.near, b.near) &&
    isSameNumber(a.far, b.far) &&
    isSameNumbers(a.viewMatrix, b.viewMatrix) &&
    isSameNumbers(a.projectionMatrix, b.projectionMatrix) &&
    isSameNumbers(wholeOf(a), wholeOf(b))
  );
}

function showsSameSplats(a: PlannedOrder, b: PlannedOrder): boolean {
  return (
    a.request.widthPx === b.request.widthPx &&
    a.request.heightPx === b.request.heightPx &&
    a.shape.accuracy === b.shape.accuracy &&
    a.shape.sortsByDistance === b.shape.sortsByDistance &&
    hasSameFields(a.budget, b.budget) &&
    a.clouds.length === b.clouds.length &&
    a.clouds.every((cloud, i) => {
      const other = b.clouds[i];
      return (
        // The last preview of a load has the planes of the finished cloud, but answers no picks.
        a.shape.clouds[i].cloud === b.shape.clouds[i].cloud &&
        a.shape.clouds[i].planes === b.shape.clouds[i].planes &&
        a.shape.clouds[i].levels === b.shape.clouds[i].levels &&
        isSameValues(cloud.cut, other.cut) &&
        cloud.version === other.version &&
        cloud.dilationPx2 === other.dilationPx2 &&
        isSameNumbers(cloud.modelMatrix, other.modelMatrix) &&
        isSameLists(cloud.instance.instances, other.instance.instances, ['modelMatrices', 'opacities']) &&
        isSameUses(
          cloud,
          other,
          (planned) => changesOrder(planned.use.hooks) || (cloud.cut !== null && showsSelection(planned)),
        )
      );
    })
  );
}

/** Whether splats have the same colours in both frames, given that `isSameOrder`. */
export function isSameColors(a: readonly CloudPlan[], b: readonly CloudPlan[]): boolean {
  return a.every((cloud, i) => {
    const other = b[i];
    return (
      (cloud.instance.shDegree ?? 3) === (other.instance.shDegree ?? 3) &&
      isSameLists(cloud.instance.instances, other.instance.instances, ['tints']) &&
      isSameUses(cloud, other, (planned) => !changesOrder(planned.use.hooks))
    );
  });
}

/** Whether the effects that pass `counts` are the same in both clouds. */
function isSameUses(a: CloudPlan, b: CloudPlan, counts: (planned: PlannedUse) => boolean): boolean {
  if (a.uses.length + b.uses.length === 0) return true;
  const [own, others] = [a.uses.filter(counts), b.uses.filter(counts)];
  return (
    own.length === others.length &&
    own.every(({ use, values, selectionVersion, resources }, i) => {
      const other = others[i];
      return (
        use.effect === other.use.effect &&
        selectionVersion === other.selectionVersion &&
        isSameValues(values, other.values) &&
        resources.every(
          ({ binding, version }, at) =>
            binding === other.resources[at].binding &&
            version !== undefined &&
            version === other.resources[at].version,
        )
      );
    })
  );
}

function isSameLists(
  a: CloudInstances | undefined,
  b: CloudInstances | undefined,
  names: readonly (keyof CloudInstances)[],
): boolean {
  return names.every((name) => {
    const [own, others] = [a?.[name], b?.[name]];
    return own && others ? isSameNumbers(own, others) : own === others;
  });
}

function isSameValues(
  a: GpuValues<GpuFields> | LevelCut | null,
  b: GpuValues<GpuFields> | LevelCut | null,
): boolean {
  if (!a || !b) return a === b;
  return Object.entries(a).every(([name, value]) => {
    const other = (b as GpuValues<GpuFields>)[name];
    return typeof value === 'number' || typeof other === 'number'
      ? isSameNumber(value as number, other as number)
      : isSameNumbers(value, other);
  });
}

function wholeOf({ wholeProjectionMatrix, projectionMatrix }: Camera): ArrayLike<number> {
  return wholeProjectionMatrix ?? projectionMatrix;
}

function isSameNumbers(a: ArrayLike<number>, b: ArrayLike<number>): boolean {
  if (a.length !== b.length) return false;
  for (let i = 0; i < a.length; i++) if (!isSameNumber(a[i], b[i])) return false;
  return true;
}

/** NaN equals itself here: otherwise a frame with a NaN would be drawn again every time. */
function isSameNumber(a: number, b: number): boolean {
  return a === b || (Number.isNaN(a) && Number.isNaN(b));
}
