import type { PackedHarmonics } from '../../packing/harmonics.ts';
import { checkPrecision } from '../../packing/precision.ts';
import type { SplatSet } from '../../splats/splat-set.ts';
import { ByteReader } from '../sources/byte-reader.ts';
import { detectFormat, SNIFF_BYTES } from '../formats/detect.ts';
import { openSource } from '../sources/open-source.ts';
import { checkSize, limitsOf } from '../sources/read-limits.ts';
import type { RowsTo } from '../formats/row-sink.ts';
import type { ReadSplatsOptions, SplatSource } from '../sources/splat-source.ts';

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
  checkPrecision({ shPrecision });
  const opened = await openSource(source, options);
  let reader: ByteReader | undefined;
  try {
    const { maxBytes, maxSplats } = limitsOf(options, opened);
    checkSize(opened, maxBytes);
    reader = new ByteReader(opened, signal, maxBytes);
    await reader.fill(SNIFF_BYTES);
    const end = reader.start + Math.min(SNIFF_BYTES, reader.available);
    const format = detectFormat(reader.bytes.subarray(reader.start, end), opened.name);
    const input = { ...opened, reader };
    const formatOptions = { shPrecision, maxSplats, signal, onProgress };
    if (rowsTo && format.readRows) return await format.readRows(input, formatOptions, rowsTo);
    return await format.read(input, formatOptions);
  } finally {
    if (reader) reader.close();
    else opened.stream.cancel().catch(() => {});
  }
}
