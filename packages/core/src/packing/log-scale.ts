/** Log scales are clamped to ± this: float32 squares of scales overflow near 44. */
export const LOG_SCALE_LIMIT = 40;

export function clampLogScale(logScale: number): number {
  return Math.max(-LOG_SCALE_LIMIT, Math.min(LOG_SCALE_LIMIT, logScale));
}
