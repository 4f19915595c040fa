import { InvalidArgumentError, SplatFileError } from '../../data/errors.ts';
import { isLeadingFile } from '../formats/formats.ts';
import { folderOf } from './inner-path.ts';
import { isBlob } from './known-source.ts';
import { openBlob } from './open-source.ts';
import type { OpenedSource, ReadOptions, SceneFiles } from './splat-source.ts';

/** Most file names in a message. */
const MOST_LISTED = 5;

/**
 * Opens the files of one scene, starting with the file that refers to all others, such as
 * `meta.json`.
 *
 * @throws InvalidArgumentError as `leadingPath`.
 */
export function openFiles(source: Required<SceneFiles>, { name }: Pick<ReadOptions, 'name'>): OpenedSource {
  const leading = leadingPath(source);
  const shownName = name ?? leading;
  const fileAt = filesBeside(source, shownName);
  return {
    ...openBlob(fileAt(leading.slice(folderOf(leading).length)), shownName),
    fileName: leading,
    openPart: async (path) => openBlob(fileAt(path), path),
  };
}

/**
 * Returns a function that finds a file by its path relative to the folder of the leading file. It
 * throws SplatFileError 'missing-part'.
 *
 * @param name of the scene in messages.
 * @throws InvalidArgumentError as `leadingPath`.
 */
export function filesBeside(source: Required<SceneFiles>, name: string): (path: string) => Blob {
  const folder = folderOf(leadingPath(source));
  const byPath = new Map(source.files.map((file, i) => [normalizedPath(source.paths[i]), file]));
  return (path) => {
    const file = byPath.get(normalizedPath(folder + path));
    if (file) return file;
    const message = `it needs ${path}, which is not among the files that were opened. Open them all together.`;
    throw new SplatFileError('missing-part', name, message);
  };
}

/**
 * Path of the file that refers to all others.
 *
 * @throws InvalidArgumentError if a file is no Blob, if the number of paths differs, or if none of several files is
 *   such a file.
 */
export function leadingPath({ files, paths }: Required<SceneFiles>): string {
  if (!files.every(isBlob))
    throw new InvalidArgumentError(
      'source',
      'source.files has an item that is not a File; pass the Files of one scene.',
    );
  if (paths.length !== files.length)
    throw new InvalidArgumentError(
      'source',
      `source has ${files.length} files and ${paths.length} paths; give each file its path.`,
    );
  const leading =
    files.length === 1
      ? paths[0]
      : outermost(paths.filter((path) => isLeadingFile(path.replace(/^.*\//, ''))));
  if (leading !== undefined) return leading;
  const names = paths.slice(0, MOST_LISTED).join(', ');
  const found = files.length === 0 ? 'source.files is empty' : `source has ${files.length} files (${names})`;
  throw new InvalidArgumentError(
    'source',
    `${found}, and none of them leads to the others, as meta.json does; pass one scene at a time.`,
  );
}

/** The leading file in the uppermost folder: a streamed scene refers to leading files in subfolders. */
function outermost(paths: readonly string[]): string | undefined {
  const depthOf = (path: string) => path.split('/').length;
  return paths.toSorted((a, b) => depthOf(a) - depthOf(b))[0];
}

/** The path without `.` and `..`. */
export function normalizedPath(path: string): string {
  const parts: string[] = [];
  for (const part of path.split('/')) {
    if (part === '..') parts.pop();
    else if (part !== '.' && part !== '') parts.push(part);
  }
  return parts.join('/');
}
