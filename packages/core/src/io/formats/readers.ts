import { openFiles } from '../sources/open-files.ts';
import { detectFormat } from './detect.ts';
import { readGzip } from './gzip/gzip.ts';
import { gzipFormat } from './gzip/gzip-format.ts';
import { type FormatReader, PACKED_READERS } from './packed-readers.ts';
import { readSog } from './sog/sog.ts';
import { sogFormat } from './sog/sog-format.ts';
import type { FormatReaders } from './splat-format.ts';
import { readZip } from './zip/zip.ts';
import { zipFormat } from './zip/zip-format.ts';

/** The code of all formats: those of a single file, and those that hold several. */
const READERS: readonly FormatReader[] = [
  ...PACKED_READERS,
  { format: sogFormat, read: readSog },
  { format: zipFormat, read: readZip },
  { format: gzipFormat, read: readGzip },
];

/** For the worker of all formats, and for threads without a worker. */
export const ALL_READERS: FormatReaders = {
  pick: (firstBytes, file, fileNames) => {
    const found = detectFormat(firstBytes, file, fileNames);
    return READERS.find(({ format }) => format === found)!.read;
  },
  openFiles,
};
