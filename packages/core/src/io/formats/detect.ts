import { type FileFinding, SplatFileError } from '../../data/errors.ts';
import { latin1 } from './first-bytes.ts';
import { FORMAT_TITLES, SPLAT_FORMATS, type SplatFormat } from './formats.ts';
import { OTHER_FILES, type OtherFile, UNREAD } from './other-files.ts';
import { SNIFF_BYTES } from './read-format.ts';

/** Files that people open by mistake, each with advice. Tried in order. */
const LOOKALIKES: readonly OtherFile[] = [
  [/^PK/, 'is an empty zip archive, or a part of one that was split'],
  [/^\x28\xb5\x2f\xfd/, 'is zstd-compressed', 'unpack it first'],
  [
    /^version https:\/\/git-lfs/,
    'is a Git LFS pointer, not the file itself',
    'run "git lfs pull" in its repository',
  ],
  [/^(?:\xef\xbb\xbf)?#usda\s/, ...UNREAD.usd],
  [
    /^(?:\xef\xbb\xbf)?\s*<(?:svg[\s>]|(?:\?xml|!--|!doctype\s+svg).*<svg[\s>])/is,
    'is a drawing (SVG), not a splat file',
  ],
  [/^# \.PCD/, 'is a point scan (PCD), not splats', 'splats come from training'],
  [
    /^(?:\xef\xbb\xbf)?\s*<(?:!doctype|html|head|body|\?xml|!--)/i,
    'is a web page or XML',
    'servers send one for a wrong address or a missing login: check the URL',
  ],
  [
    /^(?:\xef\xbb\xbf)?\s*\{.*"(?:geometricError|root)"/s,
    'is a tileset of 3D Tiles, which is not read',
    'open one of its .glb files',
  ],
  [/^(?:\xef\xbb\xbf)?\s*\{.*"(?:totalSplats|totalLevel)"|^(?:\xef\xbb\xbf)?\s*\{.*"XGrids/s, ...UNREAD.lcc],
  [/^(?:\xef\xbb\xbf)?\s*[{[]/, "looks like JSON (perhaps a server's error), not a splat file"],
  ...OTHER_FILES,
  [/^(?:\xef\xbb\xbf\s*|\s+)ply\s/, 'has bytes before its "ply" line', 'remove them'],
];

/**
 * Returns the first of `formats` that accepts a file's leading bytes together with one of its possible
 * names, for example from its URL and its download; undefined if none does.
 */
export function recognised(
  formats: readonly SplatFormat[],
  firstBytes: Uint8Array,
  fileNames: readonly string[],
): SplatFormat | undefined {
  const names = fileNames.length > 0 ? fileNames : [''];
  const matches = (format: SplatFormat) => names.some((name) => format.recognise(firstBytes, name));
  // A file that is named .splat may be any other.
  const signed = formats.find((format) => !format.lacksSignature && matches(format));
  return signed ?? formats.find(matches);
}

/**
 * Detects the format of a file by its first bytes (`SNIFF_BYTES`, or all of a shorter file). Names
 * matter only for formats without a signature.
 *
 * @param file its name in messages.
 * @param fileNames names of the file itself.
 * @throws SplatFileError 'unknown-format', which describes the bytes; 'empty' if there are none.
 */
export function detectFormat(
  firstBytes: Uint8Array,
  file = 'source',
  fileNames: readonly string[] = [file],
): SplatFormat {
  const format = recognised(SPLAT_FORMATS, firstBytes, fileNames);
  if (format) return format;
  if (firstBytes.length === 0) {
    const message = 'the file is empty (or the stream has been read before); check the download or the path.';
    throw new SplatFileError('empty', file, message, { byte: 0 });
  }
  const text = latin1(firstBytes.subarray(0, SNIFF_BYTES));
  const [, found, advice] = LOOKALIKES.find(([pattern]) => pattern.test(text)) ?? [];
  const formats = `Formats read: ${FORMAT_TITLES.join(', ')}.`;
  const finding: FileFinding = found
    ? [found, advice, formats]
    : ['is not a splat file', undefined, `${describeBytes(firstBytes)} ${formats}`];
  throw new SplatFileError('unknown-format', file, finding, { byte: 0 });
}

function describeBytes(firstBytes: Uint8Array): string {
  const hex = Array.from(firstBytes.subarray(0, 8), (byte) => byte.toString(16).padStart(2, '0')).join(' ');
  return `The first bytes (${hex}) are of no known format. A .splat file has no signature: give its name, or format 'splat'. Convert other files to PLY first.`;
}
