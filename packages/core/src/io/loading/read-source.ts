import type { PackedHarmonics } from '../../packing/harmonics.ts';
import { checkPrecision } from '../../packing/precision.ts';
import type { SplatSet } from '../../splats/splat-set.ts';
import { isGzip, unpackGzip } from '../containers/gzip.ts';
import { detectFormat, SNIFF_BYTES } from '../formats/detect.ts';
import type { RowsTo } from '../formats/row-sink.ts';
import type { ReadFormat, SplatFormat, SplatInput } from '../formats/splat-format.ts';
import { ByteReader } from '../sources/byte-reader.ts';
import { openSource } from '../sources/open-source.ts';
import { checkSize, limitsOf, unpackedLimit } from '../sources/read-limits.ts';
import { fileNameOf, isStream } from '../sources/source-kind.ts';
import type { ReadSplatsOptions, SplatSource } from '../sources/splat-source.ts';
import { OtherFormat } from './other-format.ts';

/** Returns the code that reads a format; null if that is for others. */
export type PickReader = (format: SplatFormat) => Promise<ReadFormat> | ReadFormat | null;

/**
 * Does what `readSplats` promises, with the formats that `pickReader` knows. It is a module of its own, with all code that knows
 * formats: a page whose worker reads never fetches it.
 *
 * Rejects with OtherFormat where `pickReader` leaves the file to others.
 */
export async function readSource(
  source: SplatSource,
  options: ReadSplatsOptions,
  pickReader: PickReader,
): Promise<SplatSet<PackedHarmonics>>;
/** Null if the rows of the file went to `rowsTo` as they are. */
export async function readSource(
  source: SplatSource,
  options: ReadSplatsOptions,
  pickReader: PickReader,
  rowsTo: RowsTo | undefined,
): Promise<SplatSet<PackedHarmonics> | null>;
export async function readSource(
  source: SplatSource,
  options: ReadSplatsOptions,
  pickReader: PickReader,
  rowsTo?: RowsTo,
): Promise<SplatSet<PackedHarmonics> | null> {
  const { signal, onProgress, shPrecision = 'u8' } = options;
  checkPrecision({ shPrecision });
  const opened = await openSource(source, options);
  const readers: ByteReader[] = [];
  try {
    const { maxBytes, maxSplats } = limitsOf(options, opened);
    checkSize(opened, maxBytes);
    const { stream, ...about } = opened;
    let input: SplatInput = { ...about, reader: new ByteReader(opened, signal, maxBytes) };
    readers.push(input.reader);
    let firstBytes = await firstBytesOf(input);
    if (isGzip(firstBytes)) {
      const packed = input;
      input = unpackGzip(packed, signal, unpackedLimit(options, opened));
      readers.push(input.reader);
      firstBytes = await firstBytesOf(input);
    }
    const format = detectFormat(firstBytes, opened.name, fileNameOf(source, opened.name));
    const read = await pickReader(format);
    if (!read) throw new OtherFormat(format.name, isStream(source) ? input.reader.rest() : null);
    return await read(input, { shPrecision, maxSplats, maxBytes, signal, onProgress }, rowsTo);
  } finally {
    if (readers.length === 0) opened.stream.cancel().catch(() => {});
    for (const reader of readers) reader.close();
  }
}

async function firstBytesOf({ reader }: SplatInput): Promise<Uint8Array> {
  await reader.fill(SNIFF_BYTES);
  return reader.bytes.subarray(reader.start, reader.start + Math.min(SNIFF_BYTES, reader.available));
}
