/** Log scales are clamped to ± this: float32 squares of scales overflow near 44. */
export const LOG_SCALE_LIMIT = 40;

/** Log scales of a packed chunk are unorm16 steps from `min` on. */
export interface LogScaleRange {
  readonly min: number;
  readonly step: number;
}

export function clampLogScale(logScale: number): number {
  return Math.max(-LOG_SCALE_LIMIT, Math.min(LOG_SCALE_LIMIT, logScale));
}

/** Range of clamped log scales, float32, each step rounded as in shaders/lib/pack-splat.wgsl. */
export function logScaleRange(smallest: number, largest: number): LogScaleRange {
  // Not −0, which the order of splats would decide about.
  const min = Math.fround(smallest) + 0;
  const extent = Math.fround(Math.fround(largest) - min);
  // Sizes that differ by less are one size; their step might be a number that devices flush to 0.
  const step = extent > 2 ** -80 ? Math.fround(extent * Math.fround(1 / 65535)) : 0;
  return { min, step };
}

export function logScaleSteps(logScale: number, { min, step }: LogScaleRange): number {
  if (step === 0) return 0;
  return Math.max(0, Math.min(65535, Math.round((clampLogScale(logScale) - min) / step)));
}
