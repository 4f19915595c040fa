import { guarded } from '../../data/listeners.ts';
import type { ReadHarmonics } from '../../data/packing/harmonics.ts';
import { ownShPrecision } from '../../data/packing/precision.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { type FormatReaders, SNIFF_BYTES, type SplatFormatOptions } from '../formats/read-format.ts';
import type { Passed, RowsTo } from '../formats/rows/row-sink.ts';
import { ByteReader } from '../sources/byte-reader.ts';
import { type KnownSource, namesOfOpened } from '../sources/known-source.ts';
import { openSource } from '../sources/open-source.ts';
import { checkSize, limitsOf } from '../sources/read-limits.ts';
import type { ReadSplatsOptions } from '../sources/splat-source.ts';

type ReadSourceOptions = ReadSplatsOptions & Pick<SplatFormatOptions, 'onPiece'>;

/**
 * Implements `readSplats` for the formats of `readers`. It is a separate module, so that pages with
 * workers never fetch it.
 *
 * Rejects with OtherFormat if `readers` leaves the file to another worker.
 */
export async function readSource(
  source: KnownSource,
  options: ReadSourceOptions,
  readers: FormatReaders,
): Promise<SplatSet<ReadHarmonics>>;
/** Resolves with `passed` if the file's raw rows went to `rowsTo`. */
export async function readSource(
  source: KnownSource,
  options: ReadSourceOptions,
  readers: FormatReaders,
  rowsTo: RowsTo | undefined,
): Promise<SplatSet<ReadHarmonics> | Passed>;
export async function readSource(
  source: KnownSource,
  options: ReadSourceOptions,
  { pick, checkFormat, openFiles, decodeMeshopt }: FormatReaders,
  rowsTo?: RowsTo,
): Promise<SplatSet<ReadHarmonics> | Passed> {
  const { signal, onPiece, shPrecision = 'u8' } = options;
  checkFormat?.(options.format);
  if (source.kind === 'frame') return source.frame.readFrame(ownShPrecision(shPrecision), signal);
  const opened = source.kind === 'files' ? openFiles!(source, options) : await openSource(source, options);
  let reader: ByteReader | undefined;
  try {
    const { maxBytes, maxSplats } = limitsOf(options, opened);
    checkSize(opened, maxBytes);
    reader = new ByteReader(opened, signal, maxBytes);
    const firstBytes = await reader.peek(SNIFF_BYTES);
    const { fileNames: known } = source;
    const fileNames = options.format === undefined ? [...known, ...namesOfOpened(opened)] : known;
    const read = pick(firstBytes, opened.name, fileNames);
    if (!read) throw new OtherFormat(source.kind === 'stream' ? reader.rest() : null);
    const { stream, ...about } = opened;
    return await read(
      { ...about, reader, fileNames },
      {
        shPrecision: shPrecision === 'palette' ? 'f32' : shPrecision,
        keepsPalette: shPrecision === 'palette',
        maxSplats,
        maxBytes: options.maxBytes,
        signal,
        onProgress: guarded(options.onProgress),
        onPiece,
        decodeMeshopt,
      },
      rowsTo,
    );
  } finally {
    if (reader) reader.close();
    // What failed before is on its way to the caller.
    else opened.stream.cancel().catch(() => {});
  }
}

/** Internal: the PLY worker rejects other files with it, and the other worker takes over. */
export class OtherFormat extends Error {
  /** Replaces a stream whose first bytes were consumed; null for other sources. */
  readonly stream: ReadableStream<Uint8Array> | null;

  constructor(stream: ReadableStream<Uint8Array> | null) {
    super('other format');
    this.stream = stream;
  }
}
