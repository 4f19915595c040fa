/** Whether a number is finite as float32, which shaders take. */
export function isFiniteF32(value: unknown): value is number {
  // `Number.isFinite` refuses what is no number; `Math.fround` would convert it.
  return Number.isFinite(value) && Number.isFinite(Math.fround(value as number));
}
