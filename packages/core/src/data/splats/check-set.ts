import { MOTION_VALUES } from '../../features/motion/splat-motion.data.ts';
import { InvalidArgumentError } from '../errors.ts';
import { checkKind, given, wrongArgument } from '../given.ts';
import type { PackedHarmonics } from '../packing/harmonics.ts';
import type { HarmonicsPalette } from '../packing/harmonics-palette.ts';
import {
  coefficientsPerSplat,
  SH_REST_COEFFICIENTS,
  type ShDegree,
  type SplatSet,
  type TrainedHarmonics,
} from './splat-set.ts';

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
  if (!(Number.isInteger(count) && count >= 0))
    throw wrongArgument(`${argument}.count`, count, 'a whole number');
  for (const [name, width] of Object.entries(WIDTHS))
    checkColumn(`${argument}.${name}`, set[name as keyof typeof WIDTHS], width * count);
  if (set.motion) checkColumn(`${argument}.motion`, set.motion, MOTION_VALUES * count);
  checkDegree(`${argument}.harmonics.degree`, harmonics.degree);
  checkHarmonics(`${argument}.harmonics`, harmonics as Partial<Forms>, count);
  return set;
}

/**
 * Refuses splats that move, where only splats that stand still can be handled.
 *
 * @param who subject of the message, such as `.spz`.
 * @throws InvalidArgumentError 'set'
 */
export function checkStill(isMoving: boolean, who: string): void {
  if (!isMoving) return;
  const message = `These splats move, and ${who} holds only splats that stand still. Freeze them at a time, by splatsAt or convert --time, or write a PLY.`;
  throw new InvalidArgumentError('set', message);
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
