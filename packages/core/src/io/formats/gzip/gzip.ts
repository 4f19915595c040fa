import { SplatFileError } from '../../../errors.ts';
import { readGzipped } from '../../containers/gzip.ts';
import { readPly } from '../ply/ply.ts';
import { plyFormat } from '../ply/ply-format.ts';
import { type ReadFormat, SNIFF_BYTES } from '../splat-format.ts';
import { readSpz } from '../spz/spz.ts';
import { spzFormat } from '../spz/spz-format.ts';

/** Reads what people pack by gzip: PLY, and SPZ under another name. Rejects with 'unknown-format' for anything else. */
export const readGzip: ReadFormat = (packed, options, rowsTo) =>
  readGzipped(packed, options, async (input) => {
    const firstBytes = await input.reader.peek(SNIFF_BYTES);
    if (plyFormat.recognise(firstBytes, '')) return readPly(input, options, rowsTo);
    if (spzFormat.recognise(firstBytes, '')) return readSpz(input, options, rowsTo);
    const message = 'it is packed by gzip, and what is in it is neither PLY nor SPZ; unpack it first.';
    throw new SplatFileError('unknown-format', input.name, message, { byte: 0 });
  });
