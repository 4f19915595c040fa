import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { type EffectSet, hasHook, NO_EFFECTS } from '../../gpu/effects/effect-set.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { type SortShape, sortConstants } from '../sort/sort.ts';

/** Fetched when a frame first needs a stage of the family. */
const later = () => import('./wide-keys.texts.ts');

/** Variant of the wide-keys stage to link. */
export interface WideKeysVariant {
  readonly geometryPrecision: GeometryPrecision;
  /** Whether splats are sorted by distance from the camera, not by depth; default false. */
  readonly sortsByDistance?: boolean;
  /** Effects of the page's cloud; default none. */
  readonly effects?: EffectSet;
  /** Most instances that are drawn together; null: the page is drawn once. Default null. */
  readonly batchInstances?: number | null;
}

/** Writes the sort key of each visible splat of a page in two words, as float64 has it. */
export function wideKeys(variant: WideKeysVariant): StageDefinition {
  const { effects = NO_EFFECTS, batchInstances = null } = variant;
  // Opacities and colours move nothing.
  const acting = hasHook(effects, 'splat') ? effects : NO_EFFECTS;
  return computeStage('wide-keys', {
    later,
    conditions: {
      GEOMETRY_F32: variant.geometryPrecision === 'f32',
      DISTANCE_ORDER: variant.sortsByDistance === true,
      INSTANCES: batchInstances !== null,
      SPLAT_EFFECTS: acting !== NO_EFFECTS,
    },
    effects: acting,
    constants: {
      PLACES: batchInstances ?? 1,
      ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }),
    },
  });
}

/** Puts the upper words of wide keys into the order of the lower ones. */
export function sortGather(shape: SortShape): StageDefinition {
  return computeStage('sort-gather', {
    later,
    conditions: { NARROW: shape.isNarrow },
    constants: sortConstants(shape),
  });
}
