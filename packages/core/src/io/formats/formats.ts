import { FIRST_PIECE } from '../../data/bricks/brick-files.ts';
import {
  BRICKS_MAGIC,
  CHUNK_MAGIC,
  FRAMES_MAGIC,
  isGzip,
  latin1,
  plyKindOf,
  RAD_MAGIC,
  SPZ_MAGIC,
} from './first-bytes.ts';
import { OTHER_FILES } from './other-files.ts';

/** Name, file extensions and detection of a file format, without its reader. */
export interface SplatFormat {
  /** Short lower-case name, equal to the name of the format's folder. */
  readonly name: string;
  /** Display name; several variants of a format may share it. */
  readonly title: string;
  /** File extensions in lower case, e.g. `.ply`; the usual one first. */
  readonly extensions: readonly string[];
  /** Name pattern of the file that refers to all others; absent for formats with one file. */
  readonly leadingFile?: RegExp;
  /**
   * Whether a file has this format.
   *
   * @param firstBytes the first `SNIFF_BYTES` bytes, or all of a shorter file.
   * @param fileName used only by formats without a signature.
   */
  recognise(firstBytes: Uint8Array, fileName: string): boolean;
  /** Whether no bytes tell the format, so that all others are tried before it; default false. */
  readonly lacksSignature?: boolean;
  /**
   * @internal Facts about the output of `write-NAME.ts`; absent if the format cannot be written.
   *   Defaults: title and first extension of the format, `tellsAntialiased: true`, `hasYUp: false`,
   *   `hasMotion: false`.
   */
  readonly written?: Partial<WritableFormat>;
}

/** A writable format, for pickers and messages. */
export interface WritableFormat {
  /** As in `SplatFormat`. */
  readonly name: string;
  /** Display name. */
  readonly title: string;
  /** Usual file extension, e.g. `.ply`. */
  readonly extension: string;
  /** Whether a file can state that its splats were trained with an antialias filter. */
  readonly tellsAntialiased: boolean;
  /** Whether y points up in every file of this format; in other formats it usually points down. */
  readonly hasYUp: boolean;
  /** Whether a file can hold how splats move. */
  readonly hasMotion: boolean;
}

/** Metadata of a SOG, or of a streamed one. */
export const SOG_META = /^(?:lod-)?meta\.json$/;

/** Present in every glTF, at any position. 3D Tiles use the same key with version 1. */
const GLTF_ASSET = /"asset"\s*:\s*\{[^}]*"version"\s*:\s*"2\./;

/** The beginning of a JSON object, after an optional UTF-8 byte order mark. */
const JSON_OBJECT = /^(?:\xef\xbb\xbf)?\s*\{/;

/** Signatures of readable formats that people may name .splat: gzip, zip, Zstandard, .ksplat. */
// biome-ignore lint/suspicious/noControlCharactersInRegex: they are part of the signatures
const NAMED_SPLAT = /^(\x1f\x8b\x08|PK\x03\x04|\x28\xb5\x2f\xfd|\0[^\0]\0\0)/;

/**
 * Every format, in the order of detection and of lists for people: common formats first, archives
 * last. Code is found by a format's name: `NAME/read-NAME.ts` exports `read` (`readers.ts`),
 * `NAME/write-NAME.ts` exports `write` (`writers.ts`).
 */
const ROWS = [
  {
    // PLY with splats packed in chunks of 256, by SuperSplat and splat-transform.
    name: 'compressed-ply',
    title: 'PLY',
    extensions: ['.compressed.ply'],
    recognise: (firstBytes) => plyKindOf(firstBytes) === 'compressed-ply',
    written: { title: 'Compressed PLY' },
  },
  {
    // Standard PLY of 3D Gaussian Splatting and its descendants.
    name: 'ply',
    title: 'PLY',
    extensions: ['.ply'],
    recognise: (firstBytes) => plyKindOf(firstBytes) === 'ply',
    written: { hasMotion: true },
  },
  {
    // PLY with red, green and blue in place of harmonics: points, and splats of nerfstudio.
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
    // A zip archive.
    written: { extension: '.sog' },
  },
  {
    // glTF 2.0 with KHR_gaussian_splatting; buffers may be separate files.
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
    // A tree of levels of detail by Spark; chunks may be separate files.
    name: 'rad',
    title: '.rad',
    extensions: ['.rad'],
    leadingFile: /\.rad$/,
    // The reader rejects a single chunk and names the file to open instead.
    recognise: (firstBytes) => [RAD_MAGIC, CHUNK_MAGIC].includes(latin1(firstBytes.subarray(0, 4))),
  },
  {
    // Rows of 32 bytes without a header, as antimatter15's viewer reads them.
    name: 'splat',
    title: '.splat',
    extensions: ['.splat'],
    lacksSignature: true,
    // The format has no signature. Text is excluded: PLY, web pages, and pointer files of version
    // control. A .gz may arrive unpacked if its server declares gzip as Content-Encoding.
    recognise: (firstBytes, fileName) => {
      const row = latin1(firstBytes.subarray(0, 32));
      if (!/\.splat(?:\.gz)?$/i.test(fileName) || !/[^\t\n\r\x20-\x7e]/.test(row) || NAMED_SPLAT.test(row))
        return false;
      return !OTHER_FILES.some(([pattern]) => pattern.test(row));
    },
  },
  {
    // Format of GaussianSplats3D: sections of splats in buckets, with three compression levels.
    name: 'ksplat',
    title: '.ksplat',
    extensions: ['.ksplat'],
    // No signature, but version 0.x, a level below 3, and a header that is 0 from byte 44 on.
    recognise: (firstBytes, fileName) => {
      const text = latin1(firstBytes);
      // biome-ignore lint/suspicious/noControlCharactersInRegex: the header consists of them
      if (/^\0[^\0].{18}[\0-\x02]\0.{22}\0{200}/s.test(text)) return true;
      return /\.ksplat(?:\.gz)?$/i.test(fileName) && /[^\t\n\r\x20-\x7e]/.test(text.slice(0, 32));
    },
  },
  {
    // A scene of any size with its levels of detail, in bricks that can be fetched separately.
    name: 'bricks',
    title: '.bricks',
    extensions: ['.bricks'],
    leadingFile: FIRST_PIECE,
    recognise: (firstBytes) => latin1(firstBytes).startsWith(BRICKS_MAGIC),
    written: {},
  },
  {
    // Frames of a moving scene as differences to key frames. A load shows the first.
    name: 'frames',
    title: '.frames',
    extensions: ['.frames'],
    recognise: (firstBytes) => latin1(firstBytes).startsWith(FRAMES_MAGIC),
  },
  {
    // A zip archive that contains a scene; `.sog` is one.
    name: 'zip',
    title: 'zip',
    extensions: ['.sog', '.zip'],
    recognise: (firstBytes) => latin1(firstBytes).startsWith('PK\x03\x04'),
  },
  {
    // A scene compressed by gzip, under any name.
    name: 'gzip',
    title: 'gzip',
    extensions: ['.gz'],
    recognise: isGzip,
  },
] as const satisfies readonly SplatFormat[];

/** Name of a readable format, for the option `format`. */
export type SplatFormatName = (typeof ROWS)[number]['name'];

/** Every readable format, in the order of detection and of lists for people. */
export const SPLAT_FORMATS: readonly SplatFormat[] = ROWS;

/** Display names of the formats, without duplicates. */
export const FORMAT_TITLES: readonly string[] = [...new Set(SPLAT_FORMATS.map(({ title }) => title))];

/**
 * Whether a file with this name, without folders, refers to the other files of its scene.
 *
 * @example
 * // A dropped folder holds one scene in many files, or several scenes: then load the first.
 * const isOneScene = files.some(({ name }) => isLeadingFile(name));
 * const cloud = await engine.load(isOneScene ? { files } : files[0]);
 */
export function isLeadingFile(fileName: string): boolean {
  const lower = fileName.toLowerCase();
  return SPLAT_FORMATS.some(({ leadingFile }) => leadingFile?.test(lower));
}

/**
 * The format that this file extension usually has; undefined if it is unknown or ambiguous.
 *
 * @example
 * const scene = files.find(({ name }) => formatByName(name));
 * if (scene) await engine.load(scene);
 * else label.textContent = `Drop a file of one of these formats: ${FORMAT_TITLES.join(', ')}.`;
 */
export function formatByName(fileName: string): SplatFormat | undefined {
  const lower = fileName.toLowerCase();
  return SPLAT_FORMATS.find(
    ({ extensions, leadingFile }) =>
      extensions.some((end) => lower.endsWith(end)) || leadingFile?.test(lower),
  );
}
