import type { CullSplatsVariant } from '../stages/cull/cull.ts';
import type { ProjectVariant } from '../stages/project/project.ts';

/** Variants of the stages that apply effects, for splats of degree 3. */
export const CULL = {
  isOrthographic: false,
  geometryPrecision: 'packed',
  extent: 'opacity',
  culling: 'bounding-box',
} as const satisfies CullSplatsVariant;
export const PROJECT = {
  isOrthographic: false,
  geometryPrecision: 'packed',
  recordPrecision: 'f16',
  shPrecision: 'u8',
  shortKeyBits: null,
  maxColor: 65504,
  storedShDegree: 3,
  shDegree: 3,
} as const satisfies ProjectVariant;
