import source from '../../../../../shaders/stages/ingest-keys.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Makes the sort keys that put splats into storage order. */
export function ingestKeys(geometryPrecision: GeometryPrecision): StageDefinition {
  return computeStage('ingest-keys', {
    source,
    structs: PACKING_STRUCTS,
    libraries: PACKING_LIBRARIES,
    constants: { GEOMETRY_WORDS: GEOMETRY_WORDS[geometryPrecision] },
  });
}
