import { detectFormat } from '../formats/detect.ts';
import { formatByName } from '../formats/formats.ts';
import { leadingPath, withPaths } from '../sources/open-files.ts';
import { fileNameOf, isFiles } from '../sources/source-kind.ts';
import type { SceneFiles, SplatSource } from '../sources/splat-source.ts';

import type { GivenBack } from './load-messages.ts';

/** Name of the format that a source most likely has; null if its name does not tell. */
export function likelyFormat(source: SplatSource, name: string | undefined): string | null {
  const fileName = isFiles(source) ? leadingPath(source) : fileNameOf(source, name);
  return formatByName(fileName.replace(/^.*\//, ''))?.name ?? null;
}

/**
 * Name of the format of a source that a worker gave back.
 *
 * @throws SplatFileError 'unknown-format'.
 */
export function formatOf(
  { firstBytes }: Pick<GivenBack, 'firstBytes'>,
  source: SplatSource,
  name: string | undefined,
): string {
  return detectFormat(firstBytes, name, fileNameOf(source, name)).name;
}

/**
 * `source` as workers take it: one file alone is read by any of them.
 *
 * @throws InvalidArgumentError as `withPaths`.
 */
export function postableFiles(source: SceneFiles): SceneFiles | Blob {
  const { files, paths } = withPaths(source);
  return files.length === 1 ? files[0] : { files, paths };
}
