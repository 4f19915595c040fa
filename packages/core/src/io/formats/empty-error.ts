import { SplatFileError } from '../../data/errors.ts';
import type { DropCounts } from '../../data/splats/splat-set.ts';

/** The error for a file without a valid row. */
export function emptyError(file: string, dropped: DropCounts): SplatFileError {
  const counts = Object.entries(dropped).map(([reason, count]) => `${count} ${reason}`);
  const why = counts.length === 0 ? 'it has none' : `all were left out: ${counts.join(', ')}`;
  return new SplatFileError('empty', file, `no splats to show: ${why}.`);
}
