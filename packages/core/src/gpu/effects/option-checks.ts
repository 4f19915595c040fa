import { wrongArgument } from '../../data/given.ts';
import { isFiniteF32 } from '../../data/math/float-step.ts';

export { isFiniteF32 };

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
 * @param meaning the option's meaning, for the message: `the middle of a box in world space`.
 * @throws InvalidArgumentError unless all numbers are finite in float32 and follow the rules.
 */
export function checkVector(
  argument: string,
  value: ArrayLike<number>,
  meaning: string,
  { length = 3, isNonNegative = false, isDirection = false }: VectorRules = {},
): void {
  // Callers without types may pass anything, even objects that only seem to be arrays.
  const numbers = Object(value)[Symbol.iterator] && value.length === length ? Array.from(value) : [];
  const isRight =
    numbers.length === length &&
    numbers.every(isFiniteF32) &&
    !(isNonNegative && numbers.some((number) => number < 0)) &&
    !(isDirection && numbers.every((number) => number === 0));
  if (isRight) return;
  const rule = (isNonNegative ? ', none below 0' : '') + (isDirection ? ', not all of them 0' : '');
  throw wrongArgument(argument, value, `${meaning}: ${length} finite numbers${rule}`);
}

/** @throws InvalidArgumentError unless `value` is a length of 0 or more, finite in float32. */
export function checkLength(argument: string, value: number, meaning: string): void {
  if (isFiniteF32(value) && value >= 0) return;
  throw wrongArgument(argument, value, `${meaning}: a finite number of world units, 0 or more`);
}

/** @throws InvalidArgumentError unless `value` lies in 0…`max`. */
export function checkRange(argument: string, value: number, max: number, meaning: string): void {
  if (typeof value === 'number' && value >= 0 && value <= max) return;
  throw wrongArgument(argument, value, `${meaning}, 0…${max}`);
}
