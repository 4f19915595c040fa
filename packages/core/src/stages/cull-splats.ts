import type { GeometryPrecision } from '../accuracy.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';

/** Tests each splat of one page's visible chunks. */
export function cullSplats(isOrthographic: boolean, geometryPrecision: GeometryPrecision) {
  return {
    stage: 'cull-splats',
    entryPoint: 'cullSplats',
    conditions: { ORTHOGRAPHIC: isOrthographic, GEOMETRY_F32: geometryPrecision === 'f32' },
    bindings: {
      view: [0, 'uniform'],
      page: [1, 'uniform'],
      pagePlans: [2, 'read'],
      visibleChunks: [3, 'read'],
      geometry: [4, 'read'],
      visibilityMasks: [5, 'read-write'],
      splatOffsets: [6, 'read-write'],
      depthRange: [7, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
