import { checkKind } from '../../data/given.ts';
import { SPLAT_FORMATS, type WritableFormat } from './formats.ts';

const WRITTEN = SPLAT_FORMATS.flatMap(({ name, title, extensions, written }) =>
  written ? { name, title, extension: extensions[0], tellsAntialiased: true, hasYUp: false, ...written } : [],
);

/** Every format that can be written, without the code that writes it: PLY, which every program reads, first. */
export const WRITABLE_FORMATS: readonly WritableFormat[] = WRITTEN.sort(
  (a, b) => Number(b.name === 'ply') - Number(a.name === 'ply'),
);

/** The format that files with this name are written in; undefined if the name does not tell. */
export function writableByName(fileName: string): WritableFormat | undefined {
  checkKind('fileName', fileName, 'a string');
  const lower = fileName.toLowerCase();
  // The longest end counts: `.compressed.ply` ends with `.ply`.
  return WRITABLE_FORMATS.filter(({ extension }) => lower.endsWith(extension)).sort(
    (a, b) => b.extension.length - a.extension.length,
  )[0];
}
