import { recognised } from './detect.ts';
import { SPLAT_FORMATS } from './formats.ts';
import type { ReadFormat } from './read-format.ts';

/** The code of formats whose scenes may be one file, by path. A SOG is one only as a zip archive. */
const READERS = import.meta.glob<ReadFormat>(['./*/read-*.ts', '!./{sog,zip,gzip}/*', '!./*/*.test.ts'], {
  eager: true,
  import: 'read',
});

/** Formats whose scenes people pack by gzip and zip, in the order of trial. */
const PACKED_FORMATS = SPLAT_FORMATS.filter(({ name }) => pathOf(name) in READERS);

/** Names of the packed formats for people, each once. */
export const PACKED_TITLES: readonly string[] = [...new Set(PACKED_FORMATS.map(({ title }) => title))];

/** The code that reads an unpacked file; undefined for files of other formats. See `recognised`. */
export function packedReaderOf(firstBytes: Uint8Array, fileNames: readonly string[]): ReadFormat | undefined {
  const found = recognised(PACKED_FORMATS, firstBytes, fileNames);
  return found && READERS[pathOf(found.name)];
}

/** Whether a file with this name, in lower case, is usually of a packed format. */
export function isPackedScene(fileName: string): boolean {
  return PACKED_FORMATS.some(({ extensions }) => extensions.some((end) => fileName.endsWith(end)));
}

function pathOf(formatName: string): string {
  return `./${formatName}/read-${formatName}.ts`;
}
