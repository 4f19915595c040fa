// Reasons to drop a splat, by their index in `GPU_FAULTS` (data/splats/splat-set.ts). Where several hold,
// the first counts.

const NON_FINITE_POSITION = 0u;
const NON_FINITE_SCALE = 1u;
const NON_FINITE_ROTATION = 2u;
const NON_FINITE_OPACITY = 3u;
const NON_FINITE_COLOR = 4u;
/// Number of the reasons above.
const DROP_REASONS = 5u;
const OUT_OF_BOUNDS = 5u;
/// No reason.
const SOUND = 6u;
