import type { Culling, Extent } from '../../data/accuracy/accuracy.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { NARROW_SUBGROUP } from '../../gpu/device.ts';
import {
  boundsEffects,
  type EffectSet,
  geometryEffects,
  hasHook,
  NO_EFFECTS,
} from '../../gpu/effects/effect-set.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { engineTexts } from '../family-texts.ts';
import { levelTexts } from '../levels.ts';
import type { SortDevice } from '../sort/sort.ts';

/** Variant of the cull-splats stage to link. */
export interface CullSplatsVariant {
  readonly isOrthographic: boolean;
  readonly geometryPrecision: GeometryPrecision;
  readonly extent: Extent;
  readonly culling: Culling;
  /** Whether splats are sorted by distance from the camera, not by depth; default false. */
  readonly sortsByDistance?: boolean;
  /** Effects of the page's cloud; default none. */
  readonly effects?: EffectSet;
  /** Whether all splats are balls, even after effects; default false. */
  readonly isIsotropic?: boolean;
  /** Whether splats may be merged ones, with opacities above 1; default false. */
  readonly isStacked?: boolean;
  /** Whether a cut decides which splats are drawn; default false. */
  readonly hasLevels?: boolean;
  /** Whether splats are blobs whose opacity follows dilation; default false. */
  readonly isDilated?: boolean;
  /** Most instances that are drawn together; null: the page is drawn once. Default null. */
  readonly batchInstances?: number | null;
  /** Default: any. */
  readonly sortDevice?: Pick<SortDevice, 'isNarrow'>;
}

/** Tests each splat of a page's visible chunks. */
export function cullSplats(variant: CullSplatsVariant): StageDefinition {
  const { extent, culling, effects = NO_EFFECTS } = variant;
  // Colours are not known yet.
  const acting = geometryEffects(effects);
  const isNarrow = variant.sortDevice?.isNarrow === true;
  const { batchInstances = null } = variant;
  const isPacked = variant.geometryPrecision === 'packed';
  return computeStage('cull-splats', {
    texts: engineTexts,
    ...((variant.isDilated || batchInstances !== null) && { later: levelTexts }),
    conditions: {
      NARROW: isNarrow,
      ORTHOGRAPHIC: variant.isOrthographic,
      GEOMETRY_F32: !isPacked,
      FRUSTUM_CULLING: culling === 'frustum',
      DISTANCE_ORDER: variant.sortsByDistance === true,
      ISOTROPIC: variant.isIsotropic === true,
      FIXED_EXTENT: culling !== 'frustum' && extent === 'fixed',
      STACKED: culling !== 'frustum' && variant.isStacked === true,
      LEVELS: variant.hasLevels === true,
      DILATED: variant.isDilated === true,
      INSTANCES: batchInstances !== null,
      SPLAT_EFFECTS: hasHook(acting, 'splat'),
      OPACITY_EFFECTS: hasHook(acting, 'opacity'),
      SCREEN_EFFECTS: culling !== 'frustum' && hasHook(acting, 'screen'),
    },
    effects: acting,
    constants: {
      CULL_WORKGROUP: isNarrow ? NARROW_SUBGROUP : CHUNK_SPLATS,
      ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }),
      ...(variant.isDilated && { MOST_OPACITY: LEVEL_CONSTANTS.MOST_OPACITY }),
    },
  });
}

/**
 * Tests each chunk of a page, or of all instances of a page, against the frustum; with levels, also
 * whether the cut goes through it.
 */
export function cullChunks({
  hasLevels = false,
  batchInstances = null,
  effects = NO_EFFECTS,
}: Pick<CullSplatsVariant, 'hasLevels' | 'batchInstances' | 'effects'> = {}): StageDefinition {
  const isInstanced = batchInstances !== null;
  const acting = hasLevels ? NO_EFFECTS : boundsEffects(effects);
  return computeStage('cull-chunks', {
    texts: engineTexts,
    ...((hasLevels || isInstanced) && { later: levelTexts }),
    conditions: { LEVELS: hasLevels, INSTANCES: isInstanced, BOUNDS_EFFECTS: hasHook(acting, 'bounds') },
    effects: acting,
    constants: {
      ...(hasLevels && LEVEL_CONSTANTS),
      ...(isInstanced && { BATCH_INSTANCES: batchInstances }),
    },
  });
}

/** Lists the visible splats of the frame in storage order. */
export const compactSplats: StageDefinition = /* @__PURE__ */ computeStage('compact-splats', {
  texts: engineTexts,
});

/**
 * Lists the visible chunks of the frame in storage order, and sizes the dispatches over them.
 *
 * @param isNarrow the device's `hasNarrowSubgroups`.
 */
export function planCull(isNarrow: boolean): StageDefinition {
  return computeStage('plan-cull', {
    texts: engineTexts,
    conditions: { NARROW: isNarrow },
    constants: isNarrow ? { SCAN_WORKGROUP: 1 } : {},
  });
}
