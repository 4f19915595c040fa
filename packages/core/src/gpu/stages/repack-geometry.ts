import source from '../../../../../shaders/stages/repack-geometry.wgsl?raw';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { PACKING_LIBRARIES } from './packing-libraries.ts';

/** Packs a page of float32 geometry. */
export const repackGeometry = {
  stage: 'repack-geometry',
  source,
  structs: PACKING_STRUCTS,
  libraries: PACKING_LIBRARIES,
  entryPoint: 'repackGeometry',
  conditions: { GEOMETRY_F32: true },
  bindings: {
    parameters: [0, 'uniform'],
    finer: [1, 'read'],
    coarser: [2, 'read-write'],
    chunks: [3, 'read'],
  },
} as const satisfies StageDefinition;
