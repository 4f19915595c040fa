import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { ENTRY_PRECISION, shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { BLOB_PRECISION, type CloudPrecision, type GeometryPrecision } from '../../data/packing/precision.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { levelTexts } from '../levels.ts';

/** Merges the splats of each chunk of a page, or the roots of each level above ('upper'). */
export function mergeChunks(from: GeometryPrecision | 'upper'): StageDefinition {
  return computeStage('merge-chunks', {
    later: levelTexts,
    // Blobs are float32.
    conditions: { GEOMETRY_F32: from !== 'packed', UPPER: from === 'upper' },
    constants: LEVEL_CONSTANTS,
  });
}

/** Averages the harmonics of the splats that `mergeChunks` has merged; `degree` is above 0. */
export function mergeHarmonics(degree: ShDegree, from: CloudPrecision | 'upper'): StageDefinition {
  const isUpper = from === 'upper';
  const { geometryPrecision, shPrecision } = isUpper ? BLOB_PRECISION : from;
  const isPalette = shPrecision === 'palette';
  const stored = isPalette ? ENTRY_PRECISION : shPrecision;
  return computeStage('merge-harmonics', {
    later: levelTexts,
    conditions: {
      GEOMETRY_F32: geometryPrecision === 'f32',
      UPPER: isUpper,
      SH_PALETTE: isPalette,
      SH_F32: stored === 'f32',
      SH_F16: stored === 'f16',
      SH_U8: stored === 'u8',
    },
    constants: {
      ...LEVEL_CONSTANTS,
      SH_VALUES: coefficientsPerSplat(degree),
      SH_WORDS: shWordsPerSplat(degree, stored),
      MERGED_SH_WORDS: shWordsPerSplat(degree, BLOB_PRECISION.shPrecision),
    },
  });
}
