import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../family-texts.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob(['./*.wgsl', '../../../../../shaders/lib/{harmonics-packing,pack-splat}.wgsl'], {
    query: '?raw',
    import: 'default',
    eager: true,
  }),
  PACKING_STRUCTS,
);

/** Packs a page of float32 geometry. */
export const repackGeometry: StageDefinition = /* @__PURE__ */ computeStage('repack-geometry', {
  texts,
  conditions: { GEOMETRY_F32: true },
});

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
    texts,
    conditions: { SH_F32: from === 'f32', SH_F16: from === 'f16', REPACK_TO_U8: to === 'u8' },
    constants: {
      SH_VALUES: coefficientsPerSplat(degree),
      FINER_WORDS: shWordsPerSplat(degree, from),
      COARSER_WORDS: shWordsPerSplat(degree, to),
    },
  });
}
