import { checkOneOf } from '../../data/packing/check-precision.ts';
import { openFiles } from '../sources/open-files.ts';
import { detectFormat } from './detect.ts';
import { SPLAT_FORMATS } from './formats.ts';
import type { FormatReaders, ReadFormat } from './read-format.ts';

/** The readers of all formats, by path. */
const READERS = import.meta.glob<ReadFormat>(['./*/read-*.ts', '!./*/*.test.ts'], {
  eager: true,
  import: 'read',
});

const FORMAT_NAMES = SPLAT_FORMATS.map(({ name }) => name);

/** For the worker of all formats, and for threads without a worker. */
export const ALL_READERS: FormatReaders = {
  pick: (firstBytes, file, fileNames) => {
    const { name } = detectFormat(firstBytes, file, fileNames);
    return READERS[`./${name}/read-${name}.ts`];
  },
  checkFormat: (format) => checkOneOf('format', format, FORMAT_NAMES),
  openFiles,
};
