/** Facts about the formats that can be read (`@websplatter/core/formats`), without the code that reads them. */
export { FIRST_PIECE } from '../../data/bricks/brick-files.ts';
export { FORMAT_TITLES, formatByName, isLeadingFile, SPLAT_FORMATS, type SplatFormat } from './formats.ts';
