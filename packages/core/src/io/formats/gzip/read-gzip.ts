import { type FileFinding, SplatFileError } from '../../../data/errors.ts';
import { readGzipped } from '../../containers/gzip.ts';
import { PACKED_TITLES, packedReaderOf } from '../packed-readers.ts';
import { type ReadFormat, SNIFF_BYTES } from '../read-format.ts';

/** Reads the scene in a gzip file. Rejects with 'unknown-format' for anything else in it. */
export const read: ReadFormat = (packed, options, rowsTo) =>
  readGzipped(packed, options, async (input) => {
    const firstBytes = await input.reader.peek(SNIFF_BYTES);
    const readContent = packedReaderOf(firstBytes, input.fileNames ?? []);
    if (readContent) return readContent(input, options, rowsTo);
    const finding: FileFinding = [
      `is packed by gzip, and its content is none of ${PACKED_TITLES.join(', ')}`,
      'unpack it first',
    ];
    throw new SplatFileError('unknown-format', input.name, finding, { byte: 0 });
  });
