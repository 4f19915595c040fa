import { InvalidArgumentError, SplatFileError } from '../../errors.ts';
import { SPLAT_FORMATS } from '../formats/formats.ts';
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
export function openFiles({ files }: SceneFiles, { name }: ReadOptions): OpenedSource {
  for (const file of files) {
    if (isBlob(file)) continue;
    const message = 'source.files has something else than Files; pass those of one scene.';
    throw new InvalidArgumentError('source', message);
  }
  const leading = files.length === 1 ? files[0] : leadingOf(files);
  if (!leading) {
    const names = files.slice(0, MOST_LISTED).map(pathOf).join(', ');
    const found =
      files.length === 0 ? 'source.files is empty' : `source has ${files.length} files (${names})`;
    const message = `${found}, and none of them leads to the others, as meta.json does; pass one scene at a time.`;
    throw new InvalidArgumentError('source', message);
  }
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

/** The outermost file that leads to others: those of a streamed scene lead to files of their own. */
function leadingOf(files: readonly Blob[]): Blob | undefined {
  const depthOf = (file: Blob) => pathOf(file).split('/').length;
  const leading = files.filter((file) => isLeading(pathOf(file)));
  return leading.sort((a, b) => depthOf(a) - depthOf(b))[0];
}

export function openBlob(blob: Blob, name: string): OpenedSource {
  return { name, totalBytes: blob.size, totalBytesCertain: true, isHeld: true, stream: blob.stream() };
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
