/**
 * Frames taken apart: buffers of every stage read back and compared with float64, and costs by
 * pixel. For tests and tools.
 *
 * @module
 */
export { splatsPerPage } from './clouds/cloud-planes.ts';
export { createEngine } from './create-engine.ts';
export { packCoefficients } from './data/packing/harmonics.ts';
export type { EngineSeams } from './engine.ts';
export { Pipelines } from './gpu/pipelines.ts';
export type { ShaderMutation } from './gpu/shaders/link-shader.ts';
export { type CullingComparison, type CullingMismatch, compareCulling } from './inspect/compare-culling.ts';
export { compareOrder, orderFlaw } from './inspect/compare-order.ts';
export { compareRecords, RECORD_FIELDS, type RecordField } from './inspect/compare-records.ts';
export {
  type CostRequest,
  type CountedEngine,
  type CountedView,
  countCosts,
  type FrameContributions,
  type FrameCosts,
  mapContributions,
} from './inspect/count-costs.ts';
export { FLOAT32_ROUNDING, type ProjectionErrors, projectionErrors } from './inspect/error-bounds.ts';
export { describeFieldError, type FieldError, type FieldErrors } from './inspect/field-error.ts';
export { describePixel, findNonFinite, nonFiniteWord } from './inspect/find-non-finite.ts';
export { type InspectedCloud, InspectedFrame, type InspectOptions } from './inspect/inspected-frame.ts';
export { sortKeys } from './inspect/sort-keys.ts';
export { UNSEEN_PX } from './stages/tile-costs/tile-costs.ts';
