export { FLOAT32_ROUNDING, type ProjectionErrors, projectionErrors } from './error-bounds.ts';
export { type InspectedCloud, InspectedFrame, type InspectOptions } from './inspected-frame.ts';
