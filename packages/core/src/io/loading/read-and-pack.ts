import { type PackedCloud, packCloud } from '../../packing/packed-cloud.ts';
import { checkPrecision } from '../../packing/precision.ts';
import type { Passed, RowsTo } from '../formats/row-sink.ts';
import type { FormatReaders } from '../formats/splat-format.ts';
import type { LoadProgress, ReadOptions, SplatSource } from '../sources/splat-source.ts';
import type { LoadSettings } from './load-messages.ts';
import { readSource } from './read-source.ts';

/**
 * Does a whole load in the calling thread, for the formats that `readers` has. `passed` if the rows of the file
 * went to `rowsTo` as they are.
 */
export async function readAndPack(
  source: SplatSource,
  { geometryPrecision, ...settings }: LoadSettings,
  { signal, onProgress }: Pick<ReadOptions, 'signal' | 'onProgress'>,
  readers: FormatReaders,
  rowsTo?: RowsTo,
): Promise<PackedCloud | Passed> {
  checkPrecision({ geometryPrecision });
  let last: LoadProgress | undefined;
  const watched = (progress: LoadProgress) => {
    last = progress;
    onProgress?.(progress);
  };
  const set = await readSource(source, { ...settings, signal, onProgress: watched }, readers, rowsTo);
  if (last) onProgress?.({ ...last, phase: 'arrange' });
  // Packing does not pause: this is the last chance to stop before it.
  signal?.throwIfAborted();
  if (set === 'passed') return set;
  return packCloud(set, { geometryPrecision, shPrecision: settings.shPrecision });
}
