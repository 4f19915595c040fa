import { InvalidArgumentError, SplatFileError } from '../../errors.ts';
import { SPLAT_FORMATS } from '../formats/formats.ts';
import { openBlob } from './open-blob.ts';
import { isBlob } from './source-kind.ts';
import type { OpenedSource, ReadOptions, SceneFiles } from './splat-source.ts';

/** Most names that a message lists. */
const MOST_LISTED = 5;

/**
 * Opens the files of one scene at the one that leads to the others, such as `meta.json`. They may be in folders, as far as
 * browsers tell.
 *
 * @throws InvalidArgumentError for anything but Blobs, or if several files have none that leads.
 */
export function openFiles(source: SceneFiles, { name }: ReadOptions): OpenedSource {
  const { files } = source;
  const leading = leadingFile(source);
  const folder = pathOf(leading).replace(/[^/]*$/, '');
  const byPath = new Map(files.map((file) => [normalized(pathOf(file)), file]));
  const openPart = async (path: string): Promise<OpenedSource> => {
    const file = byPath.get(normalized(folder + path));
    if (file) return openBlob(file, path);
    throw new SplatFileError(
      'missing-part',
      name ?? pathOf(leading),
      `it needs ${path}, which is not among the files that were opened. Open them all together.`,
    );
  };
  return { ...openBlob(leading, name ?? pathOf(leading)), openPart };
}

function isLeading(path: string): boolean {
  const fileName = path.replace(/^.*\//, '').toLowerCase();
  return SPLAT_FORMATS.some(({ leadingFile }) => leadingFile?.test(fileName));
}

function pathOf(file: Blob): string {
  const { webkitRelativePath, name = '' } = file as Partial<File>;
  return webkitRelativePath || name;
}

/** `path` without `.` and `..`. */
function normalized(path: string): string {
  const parts: string[] = [];
  for (const part of path.split('/')) {
    if (part === '..') parts.pop();
    else if (part !== '.' && part !== '') parts.push(part);
  }
  return parts.join('/');
}

/**
 * The file that leads to the others.
 *
 * @throws InvalidArgumentError for anything but Blobs, or if several files have none that leads.
 */
export function leadingFile({ files }: SceneFiles): Blob {
  if (!files.every(isBlob)) {
    const message = 'source.files has something else than Files; pass those of one scene.';
    throw new InvalidArgumentError('source', message);
  }
  const leading = files.length === 1 ? files[0] : files.find((file) => isLeading(pathOf(file)));
  if (leading) return leading;
  const names = files.slice(0, MOST_LISTED).map(pathOf).join(', ');
  const found = files.length === 0 ? 'source.files is empty' : `source has ${files.length} files (${names})`;
  const message = `${found}, and none of them leads to the others, as meta.json does; pass one scene at a time.`;
  throw new InvalidArgumentError('source', message);
}
