import source from '../../../../../shaders/stages/repack-sh.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import { coefficientsPerSplat } from '../../data/splats/splat-set.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Degree of a page's spherical harmonics, and the precisions to convert from and to. */
export interface RepackShVariant {
  /** Stored degree, above 0. */
  readonly degree: ShDegree;
  readonly from: 'f32' | 'f16';
  /** Coarser than `from`. */
  readonly to: 'f16' | 'u8';
}

/** Packs a page of spherical harmonics more coarsely. */
export function repackSh({ degree, from, to }: RepackShVariant): StageDefinition {
  return computeStage('repack-sh', {
    source,
    structs: PACKING_STRUCTS,
    libraries: PACKING_LIBRARIES,
    conditions: { SH_F32: from === 'f32', SH_F16: from === 'f16', REPACK_TO_U8: to === 'u8' },
    constants: {
      SH_VALUES: coefficientsPerSplat(degree),
      FINER_WORDS: shWordsPerSplat(degree, from),
      COARSER_WORDS: shWordsPerSplat(degree, to),
    },
  });
}
