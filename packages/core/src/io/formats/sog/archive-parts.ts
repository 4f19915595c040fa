import { SplatFileError } from '../../../data/errors.ts';
import { openZipEntry, readZipDirectory, type ZipEntry } from '../../containers/zip.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { openSource } from '../../sources/open-source.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import type { ReadOptions, SplatSource } from '../../sources/splat-source.ts';
import { LEADING, missingPart, pathsBeside, readOpened, type SceneParts } from './scene-files.ts';

/**
 * Opens the files of a streamed SOG in an archive. Null if the archive contains none, or several.
 *
 * Rejects as `openParts`.
 */
export async function archiveParts(
  source: Blob,
  options: Omit<ReadOptions, 'onProgress'>,
): Promise<SceneParts | null> {
  const opened = await openSource(source, options);
  const { name } = opened;
  const bytes = await readOpened(opened, options);
  const entries = new Map(readZipDirectory(bytes, name).map((entry) => [entry.path, entry]));
  const leading = [...entries.keys()].filter((path) => LEADING.test(path) && !path.startsWith('__MACOSX/'));
  if (leading.length !== 1) return null;
  const root = folderOf(leading[0]);
  const unpack = async (entry: ZipEntry): Promise<Blob> => {
    const entryName = `${name}/${entry.path}`;
    const most = unpackedLimit(options, { totalBytes: bytes.length });
    if (entry.unpackedBytes > most) {
      const message = `it unpacks to ${entry.unpackedBytes} bytes, more than ${most}. Unpack it if that is right.`;
      throw new SplatFileError('too-large', entryName, message);
    }
    const unpacked = await readOpened(openZipEntry(bytes, entry, entryName), options);
    return new Blob([unpacked]);
  };
  const open = async (path: string): Promise<SplatSource> => {
    const inside = pathsBeside(root + path, [...entries.keys()]);
    if (!inside) throw missingPart(path, name);
    const files = await Promise.all([...inside.keys()].map((at) => unpack(entries.get(at)!)));
    return { files, paths: [...inside.values()] };
  };
  return { name, meta: await readOpened(openZipEntry(bytes, entries.get(leading[0])!, name), options), open };
}
