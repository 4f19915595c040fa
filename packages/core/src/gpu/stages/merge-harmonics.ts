import source from '../../../../../shaders/stages/merge-harmonics.wgsl?raw';
import { LEVEL_CONSTANTS, LEVEL_STRUCTS } from '../../data/layout/level-structs.ts';
import { ENTRY_PRECISION, shWordsPerSplat } from '../../data/packing/harmonics.ts';
import type { CloudPrecision } from '../../data/packing/precision.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';
import type { StageDefinition } from '../pipelines.ts';
import { LEVEL_LIBRARIES } from './level-libraries.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Precision of blobs' harmonics: what merging loses is far more than a byte does. */
export const BLOB_SH_PRECISION = 'u8';

/** Averages the harmonics of what `mergeChunks` has merged; `degree` is above 0. */
export function mergeHarmonics(degree: ShDegree, from: CloudPrecision | 'upper'): StageDefinition {
  const isUpper = from === 'upper';
  const { geometryPrecision, shPrecision } = isUpper
    ? ({ geometryPrecision: 'f32', shPrecision: BLOB_SH_PRECISION } as const)
    : from;
  const isPalette = shPrecision === 'palette';
  const stored = isPalette ? ENTRY_PRECISION : shPrecision;
  return {
    stage: 'merge-harmonics',
    source,
    structs: LEVEL_STRUCTS,
    libraries: { ...PACKING_LIBRARIES, ...LEVEL_LIBRARIES },
    entryPoint: 'mergeHarmonics',
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
      MERGED_SH_WORDS: shWordsPerSplat(degree, BLOB_SH_PRECISION),
    },
  };
}
