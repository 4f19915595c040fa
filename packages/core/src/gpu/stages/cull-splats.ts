import type { Culling, Extent } from '../../data/accuracy/accuracy.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { NARROW_SUBGROUP } from '../device.ts';
import { type EffectSet, geometryEffects, hasHook, NO_EFFECTS } from '../effects/effect-set.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';
import type { SortDevice } from './sort-shape.ts';

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
    ...((variant.isDilated || batchInstances !== null) && { source: levelSource('cull-splats') }),
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
    },
    effects: acting,
    constants: {
      CULL_WORKGROUP: isNarrow ? NARROW_SUBGROUP : CHUNK_SPLATS,
      ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }),
      ...(variant.isDilated && { MOST_OPACITY: LEVEL_CONSTANTS.MOST_OPACITY }),
    },
  });
}
