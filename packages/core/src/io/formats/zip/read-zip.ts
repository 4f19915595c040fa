import { type FileFinding, SplatFileError } from '../../../data/errors.ts';
import type { ReadHarmonics } from '../../../data/packing/harmonics.ts';
import type { SplatSet } from '../../../data/splats/splat-set.ts';
import { openZipEntry, readZipDirectory, type ZipEntry } from '../../containers/zip.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { readAll } from '../../sources/read-all.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import type { OpenedSource } from '../../sources/splat-source.ts';
import { SOG_META } from '../formats.ts';
import { UNREAD } from '../other-files.ts';
import { isPackedScene, PACKED_TITLES, packedReaderOf } from '../packed-readers.ts';
import { clip } from '../ply/ply-header.ts';
import { SNIFF_BYTES, type SplatFormatOptions, type SplatInput } from '../read-format.ts';
import { ReadProgress } from '../rows/progress.ts';
import type { Passed, RowsTo } from '../rows/row-sink.ts';
import { read as readSog } from '../sog/read-sog.ts';

/** Most file names in a message. */
const MOST_LISTED = 8;

/**
 * Reads the scene in a zip archive: a SOG with its folder, or one file of another format.
 *
 * Rejects with `SplatFileError`, `SplatSourceError`, or the signal's reason.
 */
export async function read(
  input: SplatInput,
  options: SplatFormatOptions,
  rowsTo?: RowsTo,
): Promise<SplatSet<ReadHarmonics> | Passed> {
  const { name, isLocal, totalBytes } = input;
  const progress = new ReadProgress(input, options.onProgress);
  const bytes = await readAll(
    input.reader,
    Number.POSITIVE_INFINITY,
    isLocal ? totalBytes : 0,
    progress.arrived,
  );
  const entries = readZipDirectory(bytes, name).filter(({ path }) => !isByproduct(path));
  const leading = findScene(entries, name);
  const folder = folderOf(leading.path);
  let leftBytes = unpackedLimit(options, { totalBytes: bytes.length });
  const open = (entry: ZipEntry): OpenedSource => {
    const entryName = `${name}/${clip(entry.path)}`;
    leftBytes -= entry.unpackedBytes;
    if (leftBytes >= 0) return openZipEntry(bytes, entry, entryName);
    const message = `it unpacks to ${entry.unpackedBytes} bytes, more than may be in an archive of ${bytes.length}. `;
    throw new SplatFileError('too-large', entryName, `${message}Unpack it if that is right.`);
  };
  const openPart = async (path: string): Promise<OpenedSource> => {
    const wanted = folder + path.replace(/^\.\//, '');
    const entry = entries.find((each) => each.path === wanted);
    if (entry) return open(entry);
    throw new SplatFileError(
      'missing-part',
      name,
      `it needs ${clip(path)}, which is not in it. Export it again.`,
    );
  };
  const { stream, ...about } = open(leading);
  const reader = new ByteReader({ name: about.name, stream }, options.signal);
  const fileNames = [nameOf(leading)];
  const network = entries.find((entry) => DEFORMATION.test(nameOf(entry)));
  const note = network && `Its still splats are shown: ${nameOf(network)}, which moves them, is not read.`;
  try {
    const readEntry = isSogLeading(leading)
      ? readSog
      : packedReaderOf(await reader.peek(SNIFF_BYTES), fileNames);
    if (!readEntry) throw new SplatFileError('unknown-format', name, nothingRead(entries));
    return await readEntry({ ...about, reader, fileNames, note, packed: input, openPart }, options, rowsTo);
  } finally {
    reader.close();
  }
}

/** Whether macOS has added the file to the archive. */
function isByproduct(path: string): boolean {
  return /^__MACOSX\/|(?:^|\/)\._[^/]*$/.test(path);
}

/** File name without folders, in lower case. */
function nameOf({ path }: ZipEntry): string {
  return path.replace(/^.*\//, '').toLowerCase();
}

function isSogLeading(entry: ZipEntry): boolean {
  return SOG_META.test(nameOf(entry));
}

/** The scene's only or leading file. */
function findScene(entries: readonly ZipEntry[], file: string): ZipEntry {
  const depthOf = ({ path }: ZipEntry) => path.split('/').length;
  const leading = entries.filter(isSogLeading);
  // A streamed scene refers to leading files in its subfolders.
  const least = leading.reduce((depth, entry) => Math.min(depth, depthOf(entry)), Number.POSITIVE_INFINITY);
  const scenes =
    leading.length > 0
      ? leading.filter((entry) => depthOf(entry) === least)
      : entries.filter((entry) => isPackedScene(nameOf(entry)));
  if (scenes.length === 1) return scenes[0];
  const finding = scenes.length > 1 ? severalScenes(scenes) : nothingRead(entries);
  throw new SplatFileError('unknown-format', file, finding);
}

/** Networks that move the splats of a PLY (4D Gaussians, deformable Gaussians). */
const DEFORMATION = /^deform.*\.pth?$/;
/** File name patterns of archives with unsupported scenes. */
const UNREAD_ARCHIVES: readonly (readonly [name: RegExp, finding: FileFinding])[] = [
  [/\.usd[acz]?$/, UNREAD.usd],
  [/\.npy$/, UNREAD.numpy],
  [/^data\.pkl$/, UNREAD.pytorch],
  [/\.lcc$/, UNREAD.lcc],
];

function nothingRead(entries: readonly ZipEntry[]): FileFinding {
  const unread = UNREAD_ARCHIVES.find(([name]) => entries.some((entry) => name.test(nameOf(entry))));
  if (unread) return unread[1];
  const found = entries.length === 0 ? 'nothing in it' : listOf(entries);
  const titles = ['SOG', ...PACKED_TITLES].join(', ');
  return [
    `is a zip archive with ${found}`,
    `only ${titles} can be read from archives. Unpack it, and open its files`,
  ];
}

function severalScenes(entries: readonly ZipEntry[]): FileFinding {
  return [
    `is a zip archive with ${entries.length} scenes`,
    `unpack it, and open one of them: ${listOf(entries)}`,
  ];
}

function listOf(entries: readonly ZipEntry[]): string {
  const listed = entries.slice(0, MOST_LISTED).map(({ path }) => clip(path));
  if (listed.length < entries.length) listed.push(`and ${entries.length - listed.length} others`);
  return listed.join(', ');
}
