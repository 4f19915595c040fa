import { SplatFileError } from '../../../data/errors.ts';
import { openZipEntry, readZipDirectory } from '../../containers/zip.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { normalizedPath } from '../../sources/open-files.ts';
import { openBlob } from '../../sources/open-source.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import type { ReadOptions } from '../../sources/splat-source.ts';
import { LEADING, type ReadSceneFile, readOpened, type SceneFilesOfSog } from './scene-files.ts';

/**
 * Opens the files of a streamed SOG in an archive. Null if the archive contains none, or several.
 *
 * Rejects with SplatFileError if the archive is damaged, and with the signal's reason.
 */
export async function archiveFiles(
  source: Blob,
  name: string,
  options: Omit<ReadOptions, 'onProgress'>,
): Promise<SceneFilesOfSog | null> {
  const bytes = await readOpened(openBlob(source, name), options);
  const entries = new Map(readZipDirectory(bytes, name).map((entry) => [entry.path, entry]));
  const leading = [...entries.keys()].filter((path) => LEADING.test(path) && !path.startsWith('__MACOSX/'));
  if (leading.length !== 1) return null;
  const root = folderOf(leading[0]);
  const most = unpackedLimit(options, { totalBytes: bytes.length });
  const read: ReadSceneFile = async (path, signal, onBytes) => {
    const entry = entries.get(normalizedPath(root + path));
    if (!entry) {
      const message = `it needs ${path}, which is not in it. Export the scene again.`;
      throw new SplatFileError('missing-part', name, message);
    }
    const entryName = `${name}/${entry.path}`;
    if (entry.unpackedBytes > most) {
      const message = `it unpacks to ${entry.unpackedBytes} bytes, more than ${most}. Unpack it if that is right.`;
      throw new SplatFileError('too-large', entryName, message);
    }
    const { maxBytes } = options;
    const unpacked = await readOpened(openZipEntry(bytes, entry, entryName), { signal, maxBytes });
    onBytes?.(unpacked.length);
    return new Blob([unpacked]);
  };
  return { name, meta: await readOpened(openZipEntry(bytes, entries.get(leading[0])!, name), options), read };
}
