import source from '../../../../../shaders/stages/repack-geometry.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Packs a page of float32 geometry. */
export const repackGeometry: StageDefinition = /* @__PURE__ */ computeStage('repack-geometry', {
  source,
  structs: PACKING_STRUCTS,
  libraries: PACKING_LIBRARIES,
  conditions: { GEOMETRY_F32: true },
});
