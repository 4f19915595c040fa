/**
 * The file formats that are read and written, with names and extensions, for file pickers.
 *
 * @module
 */

/** Facts about the readable formats (`@websplatter/core/formats`), without their readers. */
export { FIRST_PIECE } from '../../data/bricks/brick-files.ts';
export { FORMAT_TITLES, formatByName, isLeadingFile, SPLAT_FORMATS, type SplatFormat } from './formats.ts';
