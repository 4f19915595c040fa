import { SPLAT_FORMATS } from './formats.ts';
import { type ReadFormat, recognised, type SplatFormat } from './splat-format.ts';

export interface FormatReader {
  readonly format: SplatFormat;
  readonly read: ReadFormat;
}

/** The code of formats of a single file, by path. */
const READERS: Readonly<Record<string, ReadFormat | undefined>> = import.meta.glob<ReadFormat>(
  './*/read-*.ts',
  { eager: true, import: 'read' },
);

/** Formats of a single file, which people pack by gzip and zip, in the order of trial. */
export const PACKED_READERS: readonly FormatReader[] = SPLAT_FORMATS.flatMap((format) => {
  const read = READERS[`./${format.name}/read-${format.name}.ts`];
  return read ? { format, read } : [];
});

/** Their names for people, each once. */
export const PACKED_TITLES: readonly string[] = [
  ...new Set(PACKED_READERS.map(({ format }) => format.title)),
];

/** The code that reads an unpacked file; undefined for others. See `recognised`. */
export function packedReaderOf(firstBytes: Uint8Array, fileNames: readonly string[]): ReadFormat | undefined {
  const found = recognised(
    PACKED_READERS.map(({ format }) => format),
    firstBytes,
    fileNames,
  );
  return PACKED_READERS.find(({ format }) => format === found)?.read;
}

/** Whether a file with this name, in lower case, is usually of one of these formats. */
export function isPackedScene(fileName: string): boolean {
  return PACKED_READERS.some(({ format }) => format.extensions.some((end) => fileName.endsWith(end)));
}
