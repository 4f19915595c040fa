import { InvalidArgumentError } from '../errors.ts';

/** Whether `value` is finite in float32, which shaders take. */
export function isFiniteF32(value: number): boolean {
  return Number.isFinite(value) && Number.isFinite(Math.fround(value));
}

interface VectorRules {
  /** Default 3. */
  readonly length?: number;
  /** Whether no number may be negative. */
  readonly isNonNegative?: boolean;
  /** Whether not all numbers may be 0. */
  readonly isDirection?: boolean;
}

/**
 * @param argument name of the option, e.g. `volumes[0].center`.
 * @param what meaning of the option, e.g. `the middle of a box in world space`.
 * @throws InvalidArgumentError unless all numbers are finite in float32 and follow the rules.
 */
export function checkVector(
  argument: string,
  value: ArrayLike<number>,
  what: string,
  { length = 3, isNonNegative = false, isDirection = false }: VectorRules = {},
): void {
  // Callers without types may pass anything.
  const numbers = Array.from(value ?? []);
  const isRight =
    numbers.length === length &&
    numbers.every(isFiniteF32) &&
    !(isNonNegative && numbers.some((number) => number < 0)) &&
    !(isDirection && numbers.every((number) => number === 0));
  if (isRight) return;
  const rule = (isNonNegative ? ', none below 0' : '') + (isDirection ? ', not all of them 0' : '');
  throw invalidOption(argument, value, `${what}: ${length} finite numbers${rule}`);
}

/** @throws InvalidArgumentError unless `value` is a length of 0 or more that is finite in float32. */
export function checkLength(argument: string, value: number, what: string): void {
  if (isFiniteF32(value) && value >= 0) return;
  throw invalidOption(argument, value, `${what}: a finite number of world units, 0 or more`);
}

/** Returns the error for an invalid option. `expected`: meaning of the option and its valid values. */
export function invalidOption(argument: string, value: unknown, expected: string): InvalidArgumentError {
  const found = Array.isArray(value) ? `[${value.join(', ')}]` : String(value);
  return new InvalidArgumentError(argument, `${argument} is ${found}; it is ${expected}.`);
}
