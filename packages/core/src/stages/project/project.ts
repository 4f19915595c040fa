import type { RecordPrecision, SortKeyBits } from '../../data/accuracy/accuracy.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { ENTRY_PRECISION, shWordsPerSplat } from '../../data/packing/harmonics.ts';
import type { GeometryPrecision, ShPrecision } from '../../data/packing/precision.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import { type EffectSet, hasHook, NO_EFFECTS } from '../../gpu/effects/effect-set.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { engineTexts } from '../family-texts.ts';
import { recordConditions } from '../format-conditions.ts';
import { levelTexts } from '../levels.ts';
import { type BlockShape, blockKeysOf } from '../sort/sort.ts';

/** Variant of the project stage to link. */
export interface ProjectVariant {
  readonly isOrthographic: boolean;
  readonly geometryPrecision: GeometryPrecision;
  readonly recordPrecision: RecordPrecision;
  readonly shPrecision: ShPrecision;
  /** Bits of shortened keys; null if keys keep all their bits. */
  readonly shortKeyBits: SortKeyBits | null;
  /** Largest value of a colour: see `maxColor`. */
  readonly maxColor: number;
  /** Degree that the splats are stored with. */
  readonly storedShDegree: ShDegree;
  /** Degree that is evaluated, at most the stored one. */
  readonly shDegree: ShDegree;
  /** Whether splats are sorted by distance from the camera, not by depth; default false. */
  readonly sortsByDistance?: boolean;
  /** Effects of the page's cloud; default none. */
  readonly effects?: EffectSet;
  /** Whether all splats are balls, even after effects; default false. */
  readonly isIsotropic?: boolean;
  /** Whether splats are blobs whose opacity follows dilation; default false. */
  readonly isDilated?: boolean;
  /** Most instances that are drawn together; null: the page is drawn once. Default null. */
  readonly batchInstances?: number | null;
}

/** Writes the record and the sort key of each visible splat of a page. */
export function project(variant: ProjectVariant): StageDefinition {
  const { shDegree, shortKeyBits, effects = NO_EFFECTS, batchInstances = null } = variant;
  const isPalette = variant.shPrecision === 'palette';
  const shPrecision = isPalette ? ENTRY_PRECISION : variant.shPrecision;
  return computeStage('project', {
    texts: engineTexts,
    ...((variant.isDilated || batchInstances !== null) && { later: levelTexts }),
    conditions: {
      ORTHOGRAPHIC: variant.isOrthographic,
      GEOMETRY_F32: variant.geometryPrecision === 'f32',
      ...recordConditions(variant.recordPrecision),
      SHORT_KEYS: shortKeyBits !== null,
      DISTANCE_ORDER: variant.sortsByDistance === true,
      SH_1: shDegree >= 1,
      SH_2: shDegree >= 2,
      SH_3: shDegree >= 3,
      SH_F32: shDegree >= 1 && shPrecision === 'f32',
      SH_F16: shDegree >= 1 && shPrecision === 'f16',
      SH_U8: shDegree >= 1 && shPrecision === 'u8',
      SH_PALETTE: isPalette,
      ISOTROPIC: variant.isIsotropic === true,
      DILATED: variant.isDilated === true,
      INSTANCES: batchInstances !== null,
      SPLAT_EFFECTS: hasHook(effects, 'splat'),
      OPACITY_EFFECTS: hasHook(effects, 'opacity'),
      SCREEN_EFFECTS: hasHook(effects, 'screen'),
      COLOR_EFFECTS: hasHook(effects, 'color'),
    },
    effects,
    constants: {
      MAX_COLOR: variant.maxColor,
      ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }),
      ...(variant.isDilated && { MOST_OPACITY: LEVEL_CONSTANTS.MOST_OPACITY }),
      ...(shortKeyBits !== null && { SORT_KEY_BITS: shortKeyBits }),
      ...(shDegree >= 1 && { SH_WORDS: shWordsPerSplat(variant.storedShDegree, shPrecision) }),
    },
  });
}

/**
 * Sizes the dispatches, the sort and the draw over the visible splats, and finds the place of each
 * chunk's.
 *
 * @param sort shape of the sort by depth.
 */
export function planProject(sort: BlockShape): StageDefinition {
  return computeStage('plan-project', {
    texts: engineTexts,
    conditions: { NARROW: sort.isNarrow },
    constants: { SORT_BLOCK: blockKeysOf(sort), ...(sort.isNarrow && { SCAN_WORKGROUP: 1 }) },
  });
}
