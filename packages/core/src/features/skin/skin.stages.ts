import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../../stages/family-texts.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob(['./*.wgsl', '../../../../../shaders/lib/pack-splat.wgsl'], {
    query: '?raw',
    import: 'default',
    eager: true,
  }),
  PACKING_STRUCTS,
);

/** Moves a page of geometry with joints, and writes it as it is stored. */
export function skinGeometry(precision: GeometryPrecision): StageDefinition {
  return computeStage('skin-geometry', {
    texts,
    conditions: { GEOMETRY_F32: precision === 'f32' },
  });
}
