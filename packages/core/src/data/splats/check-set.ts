import { InvalidArgumentError } from '../errors.ts';
import { checkKind, given } from '../given.ts';
import { shown } from '../printable.ts';
import { coefficientsPerSplat, SH_REST_COEFFICIENTS, type ShDegree, type SplatSet } from './splat-set.ts';

/** Values of each splat in the columns of a set. */
const WIDTHS = {
  positions: 3,
  logScales: 3,
  rotations: 4,
  opacityLogits: 1,
  colorDc: 3,
  fileIndices: 1,
} as const;

/**
 * Returns `set` if its columns have the values that its splats need, for callers without types.
 * The values may be of any size, finite or not.
 *
 * @throws InvalidArgumentError naming the member.
 */
export function givenSet<Kind extends SplatSet<{ readonly degree: ShDegree }>>(
  set: Kind,
  argument = 'set',
): Kind {
  given(set, { origin: 'a list', dropped: 'an object', harmonics: 'an object' }, argument);
  const { count, harmonics } = set;
  if (!(Number.isInteger(count) && count >= 0)) throw wrong(`${argument}.count`, count, 'a whole number');
  for (const [name, width] of Object.entries(WIDTHS))
    checkColumn(`${argument}.${name}`, set[name as keyof typeof WIDTHS], width * count);
  const { degree } = harmonics;
  if (typeof degree !== 'number' || !Object.hasOwn(SH_REST_COEFFICIENTS, degree))
    throw wrong(`${argument}.harmonics.degree`, degree, '0, 1, 2 or 3');
  const { words, wordsPerSplat, indices, entries, coefficients }: Partial<Record<string, never>> = {
    ...(harmonics as object),
  };
  if (words) {
    checkKind(`${argument}.harmonics.wordsPerSplat`, wordsPerSplat, 'a number');
    checkColumn(`${argument}.harmonics.words`, words, Number(wordsPerSplat) * count);
  } else if (indices) {
    checkColumn(`${argument}.harmonics.indices`, indices, count);
    checkColumn(`${argument}.harmonics.entries`, entries, 0);
  } else
    checkColumn(`${argument}.harmonics.coefficients`, coefficients, coefficientsPerSplat(degree) * count);
  return set;
}

function checkColumn(argument: string, column: ArrayLike<number> | undefined, length: number): void {
  checkKind(argument, column, 'a typed array');
  if (column!.length >= length) return;
  const message = `${argument} has ${column!.length} values; the splats of the set need ${length}.`;
  throw new InvalidArgumentError(argument, message);
}

function wrong(argument: string, value: unknown, expected: string): InvalidArgumentError {
  return new InvalidArgumentError(argument, `${argument} is ${shown(value)}; it must be ${expected}.`);
}
