import { checkKind } from '../../data/given.ts';

/** A format that can be written, for pickers and messages. */
export interface WritableFormat {
  /** As in `SplatFormat`. */
  readonly name: string;
  /** Its name for people. */
  readonly title: string;
  /** Usual end of a file's name, e.g. `.ply`. */
  readonly extension: string;
  /** Whether a file can say that its splats were trained with an antialias filter. */
  readonly tellsAntialiased: boolean;
  /** Whether y points up in every file of this format; in others it mostly points down. */
  readonly hasYUp: boolean;
}

/** Every format that can be written, without the code that writes it: `writers.ts` fetches that. */
export const WRITABLE_FORMATS: readonly WritableFormat[] = [
  {
    name: 'ply',
    title: 'PLY',
    extension: '.ply',
    tellsAntialiased: true,
    hasYUp: false,
  },
  {
    name: 'compressed-ply',
    title: 'Compressed PLY',
    extension: '.compressed.ply',
    tellsAntialiased: true,
    hasYUp: false,
  },
  {
    name: 'spz',
    title: 'SPZ',
    extension: '.spz',
    tellsAntialiased: true,
    hasYUp: false,
  },
  {
    name: 'sog',
    title: 'SOG',
    extension: '.sog',
    tellsAntialiased: true,
    hasYUp: false,
  },
  {
    name: 'gltf',
    title: 'glTF',
    extension: '.glb',
    tellsAntialiased: false,
    hasYUp: true,
  },
  {
    name: 'bricks',
    title: '.bricks',
    extension: '.bricks',
    tellsAntialiased: true,
    hasYUp: false,
  },
];

/** The format that files with this name are written in; undefined if the name does not tell. */
export function writableByName(fileName: string): WritableFormat | undefined {
  checkKind('fileName', fileName, 'a string');
  const lower = fileName.toLowerCase();
  // The longest end counts: `.compressed.ply` ends with `.ply`.
  return WRITABLE_FORMATS.filter(({ extension }) => lower.endsWith(extension)).sort(
    (a, b) => b.extension.length - a.extension.length,
  )[0];
}
