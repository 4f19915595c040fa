import { FIRST_PIECE } from '../../data/bricks/brick-files.ts';
import { BRICKS_MAGIC, CHUNK_MAGIC, isGzip, latin1, plyKindOf, RAD_MAGIC, SPZ_MAGIC } from './first-bytes.ts';
import { OTHER_FILES } from './other-files.ts';

/** A file format as it can be told from others, without the code that reads it. */
export interface SplatFormat {
  /** Short lower-case name; the format's folder has the same. */
  readonly name: string;
  /** Its name for people; kinds of a format share it. */
  readonly title: string;
  /** Ends of file names, in lower case, e.g. `.ply`; the usual one first. */
  readonly extensions: readonly string[];
  /** Of a format with several files: the name of the one that leads to the others. */
  readonly leadingFile?: RegExp;
  /**
   * Whether a file is of this format.
   *
   * @param firstBytes `SNIFF_BYTES` of them, or all there are.
   * @param fileName for formats that nothing in the bytes tells; others ignore it.
   */
  recognise(firstBytes: Uint8Array, fileName: string): boolean;
  /**
   * @internal Whether a source may be a scene of which views need only parts at once. The format's
   * row in `clouds/load-streamed.ts` opens it, and finds that out.
   *
   * @param name of the source or of one of its files, with folders.
   */
  readonly mayStream?: (name: string, kind: SourceKind) => boolean;
  /**
   * @internal Facts about the files that `write-NAME.ts` writes; absent if the format is not written.
   * Defaults: title and first extension of the format, `tellsAntialiased: true`, `hasYUp: false`.
   */
  readonly written?: Partial<WritableFormat>;
}

/** Kinds of sources that names may tell streamed scenes of. */
export type SourceKind = 'files' | 'blob' | 'stream' | 'other';

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

/** The file that leads to the images of a SOG, or to the parts of a streamed one. */
export const SOG_META = /^(?:lod-)?meta\.json$/;

/** Part of every glTF, at any place. 3D Tiles have the same with versions 1. */
const GLTF_ASSET = /"asset"\s*:\s*\{[^}]*"version"\s*:\s*"2\./;

/** The beginning of JSON with an object, after the mark of UTF-8 if there is one. */
const JSON_OBJECT = /^(?:\xef\xbb\xbf)?\s*\{/;

/** First bytes of readable formats that people may name .splat: gzip, zip, Zstandard, .ksplat. */
// biome-ignore lint/suspicious/noControlCharactersInRegex: they tell these formats
const NAMED_SPLAT = /^(\x1f\x8b\x08|PK\x03\x04|\x28\xb5\x2f\xfd|\0[^\0]\0\0)/;

/**
 * Every format, in the order in which files are tried and people are told of them: common ones
 * first, archives last. The code of a format is found by its name: `NAME/read-NAME.ts` exports
 * `read` (`readers.ts`), and `NAME/write-NAME.ts` exports `write` (`writers.ts`).
 */
const ROWS = [
  {
    // PLY whose splats are packed in chunks of 256, as SuperSplat and splat-transform write it.
    name: 'compressed-ply',
    title: 'PLY',
    extensions: ['.compressed.ply'],
    recognise: (firstBytes) => plyKindOf(firstBytes) === 'compressed-ply',
    written: { title: 'Compressed PLY' },
  },
  {
    // PLY as 3D Gaussian Splatting and its descendants write it.
    name: 'ply',
    title: 'PLY',
    extensions: ['.ply'],
    recognise: (firstBytes) => plyKindOf(firstBytes) === 'ply',
    written: {},
  },
  {
    // PLY with red, green and blue instead of harmonics: points, and splats of nerfstudio.
    name: 'ply-points',
    title: 'PLY',
    extensions: ['.ply'],
    recognise: (firstBytes) => plyKindOf(firstBytes) === 'ply-points',
  },
  {
    // SPZ by Niantic, versions 1 to 4; before version 4, gzip packs the whole file.
    name: 'spz',
    title: 'SPZ',
    extensions: ['.spz'],
    recognise: (firstBytes, fileName) =>
      latin1(firstBytes.subarray(0, 4)) === SPZ_MAGIC || (isGzip(firstBytes) && /\.spz$/i.test(fileName)),
    written: {},
  },
  {
    // Metadata of SOG (`meta.json`) or of streamed SOG (`lod-meta.json`), with images beside it.
    name: 'sog',
    title: 'SOG',
    extensions: ['.json'],
    leadingFile: SOG_META,
    recognise: (firstBytes, fileName) => {
      const text = latin1(firstBytes);
      if (!JSON_OBJECT.test(text)) return false;
      return /"(?:means|lodLevels)"\s*:/.test(text) || SOG_META.test(fileName.toLowerCase());
    },
    mayStream: (name, kind) =>
      /(?:^|\/)lod-meta\.json$/i.test(name) || (kind === 'blob' && /\.(?:sog|zip)$/i.test(name)),
    // Zipped, as one file.
    written: { extension: '.sog' },
  },
  {
    // glTF 2.0 with KHR_gaussian_splatting, in one file or with buffers beside it.
    name: 'gltf',
    title: 'glTF',
    extensions: ['.glb', '.gltf'],
    leadingFile: /\.gltf$/,
    recognise: (firstBytes, fileName) => {
      const text = latin1(firstBytes);
      if (text.startsWith('glTF')) return true;
      if (!JSON_OBJECT.test(text)) return false;
      return (
        /\.gltf$/i.test(fileName) || GLTF_ASSET.test(text) || /"(?:accessors|bufferViews|meshes)"/.test(text)
      );
    },
    written: { tellsAntialiased: false, hasYUp: true },
  },
  {
    // A tree of levels of detail by Spark, in chunks of the same file or of files beside it.
    name: 'rad',
    title: '.rad',
    extensions: ['.rad'],
    leadingFile: /\.rad$/,
    // The reader refuses a chunk alone, and names the file to open instead.
    recognise: (firstBytes) => [RAD_MAGIC, CHUNK_MAGIC].includes(latin1(firstBytes.subarray(0, 4))),
    mayStream: (name) => /\.rad$/i.test(name),
  },
  {
    // Rows of 32 bytes without a header, as antimatter15's viewer reads them.
    name: 'splat',
    title: '.splat',
    extensions: ['.splat'],
    // No bytes tell it. But no splat consists of letters, as PLY, web pages or pointers to files do. A
    // .gz is unpacked on the way if its server calls gzip its Content-Encoding.
    recognise: (firstBytes, fileName) => {
      const row = latin1(firstBytes.subarray(0, 32));
      if (!/\.splat(?:\.gz)?$/i.test(fileName) || !/[^\t\n\r\x20-\x7e]/.test(row) || NAMED_SPLAT.test(row))
        return false;
      return !OTHER_FILES.some(({ pattern }) => pattern.test(row));
    },
  },
  {
    // Format of GaussianSplats3D: sections of splats in buckets, in three levels of compression.
    name: 'ksplat',
    title: '.ksplat',
    extensions: ['.ksplat'],
    // No magic number, but version 0.x, a level below 3, and a header that is 0 from byte 44 on.
    recognise: (firstBytes, fileName) => {
      const text = latin1(firstBytes);
      // biome-ignore lint/suspicious/noControlCharactersInRegex: the header consists of them
      if (/^\0[^\0].{18}[\0-\x02]\0.{22}\0{200}/s.test(text)) return true;
      return /\.ksplat(?:\.gz)?$/i.test(fileName) && /[^\t\n\r\x20-\x7e]/.test(text.slice(0, 32));
    },
  },
  {
    // A scene of any size with its levels of detail, in bricks that are read one by one.
    name: 'bricks',
    title: '.bricks',
    extensions: ['.bricks'],
    leadingFile: FIRST_PIECE,
    recognise: (firstBytes) => latin1(firstBytes).startsWith(BRICKS_MAGIC),
    mayStream: (name, kind) => {
      if (kind === 'stream') return false;
      return (kind === 'files' ? FIRST_PIECE : /\.bricks(?:\.000)?$/i).test(name);
    },
    written: {},
  },
  {
    // A zip archive with a scene in it; `.sog` is one.
    name: 'zip',
    title: 'zip',
    extensions: ['.sog', '.zip'],
    recognise: (firstBytes) => latin1(firstBytes).startsWith('PK\x03\x04'),
  },
  {
    // A scene that is packed by gzip, under any name.
    name: 'gzip',
    title: 'gzip',
    extensions: ['.gz'],
    recognise: isGzip,
  },
] as const satisfies readonly SplatFormat[];

/** Name of a format that is read, as the option `format` takes it. */
export type SplatFormatName = (typeof ROWS)[number]['name'];

/** Every format that can be read, in the order in which files are tried and people are told of them. */
export const SPLAT_FORMATS: readonly SplatFormat[] = ROWS;

/** Names of the formats for people, each once. */
export const FORMAT_TITLES: readonly string[] = [...new Set(SPLAT_FORMATS.map(({ title }) => title))];

/** Whether a file with this name, without folders, leads to the others of its scene. */
export function isLeadingFile(fileName: string): boolean {
  const lower = fileName.toLowerCase();
  return SPLAT_FORMATS.some(({ leadingFile }) => leadingFile?.test(lower));
}

/** The format that files with this name usually have; undefined if the name does not tell. */
export function formatByName(fileName: string): SplatFormat | undefined {
  const lower = fileName.toLowerCase();
  return SPLAT_FORMATS.find(
    ({ extensions, leadingFile }) =>
      extensions.some((end) => lower.endsWith(end)) || leadingFile?.test(lower),
  );
}
