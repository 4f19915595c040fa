import source from '../../../../../shaders/stages/morph-geometry.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Blends two pages of geometry, and writes it as they are stored. */
export function morphGeometry(precision: GeometryPrecision): StageDefinition {
  return computeStage('morph-geometry', {
    source,
    structs: PACKING_STRUCTS,
    libraries: PACKING_LIBRARIES,
    conditions: { GEOMETRY_F32: precision === 'f32' },
  });
}
