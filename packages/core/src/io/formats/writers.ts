import { InvalidArgumentError } from '../../data/errors.ts';
import { given } from '../../data/given.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { shown } from '../../data/printable.ts';
import { givenSet } from '../../data/splats/check-set.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { WRITABLE_FORMATS } from './writable-formats.ts';
import type { WriteFormat, WriteOptions } from './write-format.ts';

/** Fetch the code of each of `WRITABLE_FORMATS`, by path. */
const WRITERS = import.meta.glob<WriteFormat>(['./*/write-*.ts', '!./*/*.test.ts'], { import: 'write' });

/**
 * Writes splats as a file in the format of this name, one of `WRITABLE_FORMATS`, whose code is fetched first. Works in the calling
 * thread and gives its event loop turns.
 *
 * Rejects with `InvalidArgumentError` if there is no such format ('formatName'), or if it cannot hold these splats ('set'); or with the
 * signal's reason.
 */
export async function writeSplats(
  set: SplatSet<Harmonics>,
  formatName: string,
  options: WriteOptions = {},
): Promise<Uint8Array<ArrayBuffer>> {
  const names = WRITABLE_FORMATS.map(({ name }) => name);
  if (!names.includes(formatName)) {
    const message = `${shown(formatName)} cannot be written; the format must be one of ${names.join(', ')}.`;
    throw new InvalidArgumentError('formatName', message);
  }
  given(options);
  if (givenSet(set).count === 0) throw new InvalidArgumentError('set', 'There are no splats to write.');
  const write = await WRITERS[`./${formatName}/write-${formatName}.ts`]();
  return write(set, options);
}
