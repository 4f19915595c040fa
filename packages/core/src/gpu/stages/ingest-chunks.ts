import source from '../../../../../shaders/stages/ingest-chunks.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Takes the bounds of each chunk of a page, and settles its splats. */
export function ingestChunks(geometryPrecision: GeometryPrecision): StageDefinition {
  return computeStage('ingest-chunks', {
    source,
    structs: PACKING_STRUCTS,
    libraries: PACKING_LIBRARIES,
    conditions: { GEOMETRY_F32: geometryPrecision === 'f32' },
    constants: { GEOMETRY_WORDS: GEOMETRY_WORDS[geometryPrecision] },
  });
}
