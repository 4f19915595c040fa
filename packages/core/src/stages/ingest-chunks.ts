import source from '../../../../shaders/stages/ingest-chunks.wgsl?raw';
import type { StageDefinition } from '../gpu/pipelines.ts';
import { PACKING_STRUCTS } from '../layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../packing/geometry.ts';
import type { GeometryPrecision } from '../packing/precision.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Takes the bounds of each chunk of a page. */
export function ingestChunks(geometryPrecision: GeometryPrecision) {
  return {
    stage: 'ingest-chunks',
    source,
    structs: PACKING_STRUCTS,
    libraries: PACKING_LIBRARIES,
    entryPoint: 'ingestChunks',
    conditions: { GEOMETRY_F32: geometryPrecision === 'f32' },
    constants: { GEOMETRY_WORDS: GEOMETRY_WORDS[geometryPrecision] },
    bindings: {
      parameters: [0, 'uniform'],
      geometry: [1, 'read'],
      chunks: [2, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
