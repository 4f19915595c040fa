import { type FilePlace, SplatFileError } from '../../../data/errors.ts';
import type { DropCounts } from '../../../data/splats/splat-set.ts';

/** Largest number of splats that `SplatSet.fileIndices` can index. */
const MAX_SPLATS = 2 ** 32 - 1;

/**
 * Checks the number of splats in a header.
 *
 * @throws SplatFileError 'empty', 'too-large'.
 */
export function checkCount(count: number, file: string, maxSplats: number, place: FilePlace = {}): void {
  if (count === 0) throw new SplatFileError('empty', file, 'the header promises 0 splats.', place);
  if (count > MAX_SPLATS) {
    const message = `the header promises ${count} splats; at most ${MAX_SPLATS} can be numbered. Split the file.`;
    throw new SplatFileError('too-large', file, message, place);
  }
  if (count > maxSplats) {
    const message = `it has ${count} splats, more than maxSplats, ${maxSplats}. Pass a larger maxSplats if there is memory for them.`;
    throw new SplatFileError('too-large', file, message, place);
  }
}

/** The error for a file without a valid row. */
export function emptyError(file: string, dropped: DropCounts): SplatFileError {
  const counts = Object.entries(dropped).map(([reason, count]) => `${count} ${reason}`);
  const why = counts.length === 0 ? 'it has none' : `all were left out: ${counts.join(', ')}`;
  return new SplatFileError('empty', file, `no splats to show: ${why}.`);
}
