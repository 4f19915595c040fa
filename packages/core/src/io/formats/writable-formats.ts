import { checkKind } from '../../data/given.ts';
import { SPLAT_FORMATS, type WritableFormat } from './formats.ts';

const DEFAULTS = { tellsAntialiased: true, hasYUp: false, hasMotion: false };

const WRITTEN = SPLAT_FORMATS.flatMap(({ name, title, extensions, written }) =>
  written ? { name, title, extension: extensions[0], ...DEFAULTS, ...written } : [],
);

/** Every writable format, without its writer. PLY comes first, because every program reads it. */
export const WRITABLE_FORMATS: readonly WritableFormat[] = WRITTEN.sort(
  (a, b) => Number(b.name === 'ply') - Number(a.name === 'ply'),
);

/**
 * The format for files with this extension; undefined if there is none.
 *
 * @example
 * const format = writableByName('garden.compressed.ply');
 * if (format) await writeSplats(await readSplats('/garden.ply'), format.name);
 */
export function writableByName(fileName: string): WritableFormat | undefined {
  checkKind('fileName', fileName, 'a string');
  const lower = fileName.toLowerCase();
  // The longest extension wins: `.compressed.ply` also ends with `.ply`.
  return WRITABLE_FORMATS.filter(({ extension }) => lower.endsWith(extension)).sort(
    (a, b) => b.extension.length - a.extension.length,
  )[0];
}
