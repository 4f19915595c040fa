export { splatsPerPage } from '../clouds/cloud-planes.ts';
export { packCoefficients } from '../data/packing/harmonics.ts';
export { Pipelines } from '../gpu/pipelines.ts';
export type { ShaderMutation } from '../gpu/shaders/link-shader.ts';
export { UNSEEN_PX } from '../stages/tile-costs/tile-costs.ts';
export { type CullingComparison, type CullingMismatch, compareCulling } from './compare-culling.ts';
export { compareOrder, orderFlaw } from './compare-order.ts';
export { compareRecords, RECORD_FIELDS, type RecordField } from './compare-records.ts';
export {
  type CostRequest,
  type CountedEngine,
  type CountedView,
  countCosts,
  type FrameContributions,
  type FrameCosts,
  mapContributions,
} from './count-costs.ts';
export { FLOAT32_ROUNDING, type ProjectionErrors, projectionErrors } from './error-bounds.ts';
export { describeFieldError, type FieldError, type FieldErrors } from './field-error.ts';
export { describePixel, findNonFinite, nonFiniteWord } from './find-non-finite.ts';
export { type InspectedCloud, InspectedFrame, type InspectOptions } from './inspected-frame.ts';
export { sortKeys } from './sort-keys.ts';
