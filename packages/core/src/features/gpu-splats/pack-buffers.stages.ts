import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { GPU_FAULTS } from '../../data/splats/splat-set.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../../stages/family-texts.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob(['./*.wgsl', '../../../../../shaders/lib/{drop-reason,float-bits,pack-splat}.wgsl'], {
    query: '?raw',
    import: 'default',
    eager: true,
  }),
  PACKING_STRUCTS,
);

/** Buffers to read, and what to write. */
export interface PackBuffersVariant {
  readonly geometryPrecision: GeometryPrecision;
  readonly hasRotations: boolean;
  readonly hasOpacities: boolean;
  /** Whether splats with faults are counted. */
  readonly countsFaults: boolean;
}

/** Packs a page of splats from the application's buffers. */
export function packBuffers(variant: PackBuffersVariant): StageDefinition {
  const { geometryPrecision, hasRotations, hasOpacities, countsFaults } = variant;
  return computeStage('pack-buffers', {
    texts,
    conditions: {
      GEOMETRY_F32: geometryPrecision === 'f32',
      ROTATIONS: hasRotations,
      OPACITIES: hasOpacities,
      COUNTS_FAULTS: countsFaults,
    },
    constants: { FAULTS: GPU_FAULTS.length },
  });
}
