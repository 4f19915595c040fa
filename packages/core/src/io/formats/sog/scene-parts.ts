import { CodeUnavailableError } from '../../../data/errors.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { leadingPath, openFiles, withPaths } from '../../sources/open-files.ts';
import { openSource } from '../../sources/open-source.ts';
import { fetchedPart } from '../../sources/read-part.ts';
import { isBlob, isFiles } from '../../sources/source-kind.ts';
import type { ReadOptions, SceneFiles, SplatSource } from '../../sources/splat-source.ts';
import { LEADING, missingPart, pathsBeside, readOpened, type SceneParts } from './scene-files.ts';
import { MAX_META_BYTES } from './sog-meta.ts';

/** Bytes that the directory of an archive of 50,000 files takes. */
const DIRECTORY_BYTES = 4 << 20;

/**
 * Opens the files of a streamed SOG; returns null for an archive without one.
 *
 * Rejects as `openSource`, and with SplatFileError for archives that are damaged.
 */
export async function openParts(
  source: SplatSource,
  options: Omit<ReadOptions, 'onProgress'>,
): Promise<SceneParts | null> {
  if (isBlob(source) && !LEADING.test((source as Partial<File>).name ?? options.name ?? '')) {
    // Its directory, which is at the end, has the names: other archives are not read for nothing.
    const end = await source.slice(-DIRECTORY_BYTES).text();
    if (!/lod-meta\.json/i.test(end)) return null;
    const { archiveParts } = await import('./archive-parts.ts').catch((cause) => {
      throw new CodeUnavailableError('streaming', { cause });
    });
    return archiveParts(source, options);
  }
  const files = isBlob(source) ? { files: [source] } : source;
  const opened = isFiles(files) ? openFiles(files, options) : await openSource(files, options);
  const meta = await readOpened(opened, options, MAX_META_BYTES + 1);
  const { name } = opened;
  const open = async (path: string): Promise<SplatSource> =>
    isFiles(files) ? besides(files, path, name) : fetchedPart(opened, path).url;
  return { name, meta, open };
}

/** The files of a scene that lie beside one of them, which leads to the others. */
function besides(source: SceneFiles, path: string, name: string): SceneFiles {
  const { files, paths } = withPaths(source);
  const inside = pathsBeside(folderOf(leadingPath(source)) + path, paths);
  if (!inside) throw missingPart(path, name);
  return { files: [...inside.keys()].map((at) => files[paths.indexOf(at)]), paths: [...inside.values()] };
}
