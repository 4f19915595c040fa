import type { Culling, Extent, GeometryPrecision } from '../accuracy.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';

/** What the cull-splats stage is linked for. */
export interface CullSplatsVariant {
  readonly isOrthographic: boolean;
  readonly geometryPrecision: GeometryPrecision;
  readonly extent: Extent;
  readonly culling: Culling;
}

/** Tests each splat of one page's visible chunks. */
export function cullSplats({ isOrthographic, geometryPrecision, extent, culling }: CullSplatsVariant) {
  return {
    stage: 'cull-splats',
    entryPoint: 'cullSplats',
    conditions: {
      ORTHOGRAPHIC: isOrthographic,
      GEOMETRY_F32: geometryPrecision === 'f32',
      FRUSTUM_CULLING: culling === 'frustum',
      FIXED_EXTENT: culling !== 'frustum' && extent === 'fixed',
    },
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
