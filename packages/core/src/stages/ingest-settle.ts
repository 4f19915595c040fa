import source from '../../../../shaders/stages/ingest-settle.wgsl?raw';
import type { BindingKind, StageDefinition } from '../gpu/pipelines.ts';
import { PACKING_STRUCTS } from '../layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../packing/geometry.ts';
import type { GeometryPrecision } from '../packing/precision.ts';

/** Gives splats their place about the cloud's origin, and their log scales in steps of the cloud's range. */
export function ingestSettle(geometryPrecision: GeometryPrecision): StageDefinition {
  const bindings: Record<string, readonly [number, BindingKind]> = {
    parameters: [0, 'uniform'],
    geometry: [1, 'read-write'],
  };
  if (geometryPrecision === 'packed') bindings.logScaleRests = [2, 'read'];
  return {
    stage: 'ingest-settle',
    source,
    structs: PACKING_STRUCTS,
    entryPoint: 'ingestSettle',
    conditions: { GEOMETRY_F32: geometryPrecision === 'f32' },
    constants: { GEOMETRY_WORDS: GEOMETRY_WORDS[geometryPrecision] },
    bindings,
  };
}
