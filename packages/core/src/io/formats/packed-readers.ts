import { recognised } from './detect.ts';
import { SPLAT_FORMATS } from './formats.ts';
import type { ReadFormat } from './read-format.ts';

/** Readers of formats with single-file scenes, by path. A SOG is a single file only as a zip archive. */
const READERS = import.meta.glob<ReadFormat>(['./*/read-*.ts', '!./{sog,zip,gzip}/*', '!./*/*.test.ts'], {
  eager: true,
  import: 'read',
});

/** Formats that people compress by gzip and zip, in the order of detection. */
const PACKED_FORMATS = SPLAT_FORMATS.filter(({ name }) => pathOf(name) in READERS);

/** Display names of these formats, without duplicates. */
export const PACKED_TITLES: readonly string[] = [...new Set(PACKED_FORMATS.map(({ title }) => title))];

/** The reader of an unpacked file; undefined for other formats. See `recognised`. */
export function packedReaderOf(firstBytes: Uint8Array, fileNames: readonly string[]): ReadFormat | undefined {
  const found = recognised(PACKED_FORMATS, firstBytes, fileNames);
  return found && READERS[pathOf(found.name)];
}

/** Whether a file with this lower-case name usually has one of these formats. */
export function isPackedScene(fileName: string): boolean {
  return PACKED_FORMATS.some(({ extensions }) => extensions.some((end) => fileName.endsWith(end)));
}

function pathOf(formatName: string): string {
  return `./${formatName}/read-${formatName}.ts`;
}
