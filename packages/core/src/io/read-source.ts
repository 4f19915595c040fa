import type { PackedHarmonics } from '../packing/harmonics.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { detectFormat, SNIFF_BYTES } from './detect.ts';
import { openSource, peekSource } from './open-source.ts';
import type { RowsTo } from './row-sink.ts';
import type { ReadSplatsOptions, SplatSource } from './splat-source.ts';

/**
 * Does what `readSplats` promises. It is a module of its own, with all code that knows formats: a page whose worker
 * reads never fetches it.
 */
export async function readSource(
  source: SplatSource,
  options?: ReadSplatsOptions,
): Promise<SplatSet<PackedHarmonics>>;
/** Null if the rows of the file went to `rowsTo` as they are. */
export async function readSource(
  source: SplatSource,
  options: ReadSplatsOptions,
  rowsTo: RowsTo | undefined,
): Promise<SplatSet<PackedHarmonics> | null>;
export async function readSource(
  source: SplatSource,
  options: ReadSplatsOptions = {},
  rowsTo?: RowsTo,
): Promise<SplatSet<PackedHarmonics> | null> {
  const { signal, onProgress, shPrecision = 'u8' } = options;
  const opened = await openSource(source, options);
  const { firstBytes, source: whole } = await peekSource(opened, SNIFF_BYTES, signal);
  try {
    const format = detectFormat(firstBytes, whole.name);
    const formatOptions = { shPrecision, signal, onProgress };
    if (rowsTo && format.readRows) return await format.readRows(whole, formatOptions, rowsTo);
    return await format.read(whole, formatOptions);
  } catch (error) {
    // A source of unknown format has no reader that would release it.
    if (!whole.stream.locked) whole.stream.cancel(error).catch(() => {});
    throw error;
  }
}
