import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { type EffectSet, hasHook, NO_EFFECTS } from '../effects/effect-set.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { wideKeySource } from '../shaders/later-source.ts';

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
    source: wideKeySource('wide-keys'),
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
