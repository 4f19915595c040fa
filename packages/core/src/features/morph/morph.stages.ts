import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import type { GeometryPrecision, OwnShPrecision } from '../../data/packing/precision.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../../stages/family-texts.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob(['./*.wgsl', '../../../../../shaders/lib/{harmonics-packing,pack-splat}.wgsl'], {
    query: '?raw',
    import: 'default',
    eager: true,
  }),
  PACKING_STRUCTS,
);

/** Blends two pages of geometry, and writes it as they are stored. */
export function morphGeometry(precision: GeometryPrecision): StageDefinition {
  return computeStage('morph-geometry', {
    texts,
    conditions: { GEOMETRY_F32: precision === 'f32' },
  });
}

/** Blends two pages of spherical harmonics of a degree above 0, and writes them as they are stored. */
export function morphSh(degree: ShDegree, precision: OwnShPrecision): StageDefinition {
  return computeStage('morph-sh', {
    texts,
    conditions: { SH_F32: precision === 'f32', SH_F16: precision === 'f16', SH_U8: precision === 'u8' },
    constants: { SH_VALUES: coefficientsPerSplat(degree), SH_WORDS: shWordsPerSplat(degree, precision) },
  });
}
