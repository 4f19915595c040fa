import { checkKind, given, wrongArgument } from '../given.ts';
import type { PackedHarmonics } from '../packing/harmonics.ts';
import type { HarmonicsPalette } from '../packing/harmonics-palette.ts';
import { COLUMNS, OPTIONAL_COLUMNS } from './columns.ts';
import {
  coefficientsPerSplat,
  SH_REST_COEFFICIENTS,
  type ShDegree,
  type SplatSet,
  type TrainedHarmonics,
} from './splat-set.ts';

const IS_OPTIONAL = new Set<string>(OPTIONAL_COLUMNS.map(({ name }) => name));

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
  if (!(Number.isInteger(count) && count >= 0))
    throw wrongArgument(`${argument}.count`, count, 'a whole number');
  for (const { name, width } of COLUMNS)
    if (set[name] || !IS_OPTIONAL.has(name)) checkColumn(`${argument}.${name}`, set[name], width * count);
  checkDegree(`${argument}.harmonics.degree`, harmonics.degree);
  checkHarmonics(`${argument}.harmonics`, harmonics as Partial<Forms>, count);
  return set;
}

/** @throws InvalidArgumentError unless there are harmonics of this degree. */
export function checkDegree(argument: string, degree: ShDegree, owner?: string): void {
  if (typeof degree === 'number' && Object.hasOwn(SH_REST_COEFFICIENTS, degree)) return;
  throw wrongArgument(argument, degree, '0, 1, 2 or 3', owner);
}

/** Members of all forms that harmonics have. */
type Forms = TrainedHarmonics & PackedHarmonics & HarmonicsPalette;

function checkHarmonics(
  argument: string,
  { degree, words, wordsPerSplat, indices, entries, coefficients }: Partial<Forms>,
  count: number,
): void {
  if (words) {
    checkKind(`${argument}.wordsPerSplat`, wordsPerSplat, 'a number');
    checkColumn(`${argument}.words`, words, count * wordsPerSplat!);
  } else if (indices) {
    checkColumn(`${argument}.indices`, indices, count);
    checkColumn(`${argument}.entries`, entries, 0);
  } else checkColumn(`${argument}.coefficients`, coefficients, count * coefficientsPerSplat(degree!));
}

function checkColumn(argument: string, column: ArrayLike<number> | undefined, length: number): void {
  checkKind(argument, column, 'a typed array');
  if (!(column!.length >= length))
    throw wrongArgument(`${argument}.length`, column!.length, `${length}, for the splats of the set`);
}
