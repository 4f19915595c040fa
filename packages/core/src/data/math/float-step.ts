/** Whether `value` is a number that is finite in float32, as which the GPU and columns of splats hold it. */
export function isFiniteF32(value: unknown): value is number {
  // Math.fround would convert what is no number.
  return typeof value === 'number' && Number.isFinite(Math.fround(value));
}

/** Digits of float32 after the leading one, in binary. */
const DIGITS = 23;
/** Exponents of the least normal float32; steps below are all alike. */
const LEAST_EXPONENT = -126;

/** The distance of neighbouring float32 numbers around `value`: its unit in the last place. */
export function floatStep(value: number): number {
  const magnitude = Math.abs(value);
  if (!(magnitude >= 2 ** LEAST_EXPONENT)) return 2 ** (LEAST_EXPONENT - DIGITS);
  let exponent = Math.floor(Math.log2(magnitude));
  // The logarithm is rounded.
  if (2 ** exponent > magnitude) exponent--;
  else if (2 ** (exponent + 1) <= magnitude) exponent++;
  return 2 ** (exponent - DIGITS);
}

/** The largest float32 that is not above `value`. */
export function floatBelow(value: number): number {
  const nearest = Math.fround(value);
  return nearest > value ? Math.fround(nearest - floatStep(value)) : nearest;
}

/** The least float32 that is not below `value`. */
export function floatAbove(value: number): number {
  return -floatBelow(-value);
}
