import source from '../../../../../shaders/stages/morph-sh.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import type { OwnShPrecision } from '../../data/packing/precision.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Blends two pages of spherical harmonics of a degree above 0, and writes them as they are stored. */
export function morphSh(degree: ShDegree, precision: OwnShPrecision): StageDefinition {
  return computeStage('morph-sh', {
    source,
    structs: PACKING_STRUCTS,
    libraries: PACKING_LIBRARIES,
    conditions: { SH_F32: precision === 'f32', SH_F16: precision === 'f16', SH_U8: precision === 'u8' },
    constants: { SH_VALUES: coefficientsPerSplat(degree), SH_WORDS: shWordsPerSplat(degree, precision) },
  });
}
