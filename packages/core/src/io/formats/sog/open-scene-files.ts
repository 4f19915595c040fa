import { fetched } from '../../../data/errors.ts';
import { filesBeside, openFiles } from '../../sources/open-files.ts';
import { openSource } from '../../sources/open-source.ts';
import { isBlob, isFiles } from '../../sources/source-kind.ts';
import type { ReadOptions, SplatSource } from '../../sources/splat-source.ts';
import { partsAt } from './fetch-file.ts';
import { LEADING, type ReadPart, readOpened, type SceneFilesOfSog } from './scene-files.ts';
import { MAX_META_BYTES } from './sog-meta.ts';

/** Directory size of an archive with 50,000 files. */
const DIRECTORY_BYTES = 4 << 20;

/**
 * Opens the files of a streamed SOG; null for an archive without one.
 *
 * Rejects as `openSource`, and with SplatFileError if an archive is damaged.
 */
export async function openSceneFiles(
  source: SplatSource,
  options: Omit<ReadOptions, 'onProgress'>,
): Promise<SceneFilesOfSog | null> {
  if (isBlob(source) && !LEADING.test((source as Partial<File>).name ?? options.name ?? '')) {
    // The directory at its end lists the names, so other archives need not be read.
    const end = await source.slice(-DIRECTORY_BYTES).text();
    if (!/lod-meta\.json/i.test(end)) return null;
    const { archiveFiles } = await fetched('streaming', import('./archive-files.ts'));
    return archiveFiles(source, options);
  }
  const files = isBlob(source) ? { files: [source] } : source;
  const opened = isFiles(files) ? openFiles(files, options) : await openSource(files, options);
  const meta = await readOpened(opened, options, MAX_META_BYTES + 1);
  const { name } = opened;
  if (isFiles(files)) {
    const fileAt = filesBeside(files, name);
    const read: ReadPart = async (path, _, onBytes) => {
      const file = fileAt(path);
      onBytes?.(file.size);
      return file;
    };
    return { name, meta, read };
  }
  return { name, meta, read: partsAt(opened, options), fetched: opened.fetched };
}
