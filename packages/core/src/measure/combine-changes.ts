import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import type { Candidate } from './candidates.ts';

/** Error and rough time of a candidate. */
export interface FirstLook {
  readonly candidate: Candidate;
  readonly psnrDb: number;
  readonly totalMs: number;
}

const MAX_FASTER = 4;
const MAX_FINER = 3;
/** The largest number of combinations that `combineChanges` returns. */
export const MAX_COMBINATIONS = MAX_FASTER + MAX_FINER;
/** Changes that save less than this fraction of the base's time are not combined. */
const MIN_SAVING = 0.02;

/**
 * Combines changes of single settings that are likely to lie on the front. One series adds the
 * changes with the most time saved per error, one after the other; another series adds the changes
 * with the most accuracy gained per time. Assumes that squared errors and times add up; the
 * combinations themselves are measured afterwards.
 *
 * @param singles candidates that differ from the base in one setting.
 * @returns the changes of each combination: two settings or more, no combination twice.
 */
export function combineChanges(base: FirstLook, singles: readonly FirstLook[]): Partial<AccuracySettings>[] {
  const baseError = squaredError(base);
  const faster = singles
    .filter(({ totalMs }) => totalMs < (1 - MIN_SAVING) * base.totalMs)
    .map((look) => ({
      look,
      merit: (base.totalMs - look.totalMs) / Math.max(squaredError(look) - baseError, Number.EPSILON),
    }));
  const finer = singles
    .filter((look) => squaredError(look) < baseError)
    .map((look) => ({
      look,
      merit: (baseError - squaredError(look)) / Math.max(look.totalMs - base.totalMs, 0.01 * base.totalMs),
    }));
  return [...cumulated(faster, MAX_FASTER), ...cumulated(finer, MAX_FINER)];
}

/** Joins the best change, measured already, with the next best of another setting, and so on. */
function cumulated(
  changes: readonly { readonly look: FirstLook; readonly merit: number }[],
  limit: number,
): Partial<AccuracySettings>[] {
  const found: Partial<AccuracySettings>[] = [];
  let together: Partial<AccuracySettings> = {};
  for (const { look } of [...changes].sort((a, b) => b.merit - a.merit)) {
    const { settings, changed } = look.candidate;
    const [name] = changed;
    if (Object.hasOwn(together, name)) continue;
    together = { ...together, [name]: settings[name] };
    if (Object.keys(together).length > 1) found.push(together);
    if (found.length === limit) break;
  }
  return found;
}

function squaredError({ psnrDb }: FirstLook): number {
  return 10 ** (-psnrDb / 10);
}
