import { detectFormat } from '../formats/detect.ts';
import { formatByName } from '../formats/formats.ts';
import { leadingPath, withPaths } from '../sources/open-files.ts';
import { fileNameOf, isFiles } from '../sources/source-kind.ts';
import type { SceneFiles, SplatSource } from '../sources/splat-source.ts';

import type { GivenBack } from './load-messages.ts';

/** A worker for each format but PLY, which `load-splats.ts` starts by itself. In one piece each, the form that bundlers recognise. */
export const WORKERS: Readonly<Record<string, () => Worker>> = {
  spz: () => new Worker(new URL('../formats/spz/spz-worker.ts', import.meta.url), { type: 'module' }),
  gzip: () => new Worker(new URL('../formats/gzip/gzip-worker.ts', import.meta.url), { type: 'module' }),
  gltf: () => new Worker(new URL('../formats/gltf/gltf-worker.ts', import.meta.url), { type: 'module' }),
  sog: () => new Worker(new URL('../formats/sog/sog-worker.ts', import.meta.url), { type: 'module' }),
  zip: () => new Worker(new URL('../formats/zip/zip-worker.ts', import.meta.url), { type: 'module' }),
  'compressed-ply': () =>
    new Worker(new URL('../formats/compressed-ply/compressed-ply-worker.ts', import.meta.url), {
      type: 'module',
    }),
  ksplat: () =>
    new Worker(new URL('../formats/ksplat/ksplat-worker.ts', import.meta.url), { type: 'module' }),
  'ply-points': () =>
    new Worker(new URL('../formats/ply-points/ply-points-worker.ts', import.meta.url), { type: 'module' }),
  splat: () => new Worker(new URL('../formats/splat/splat-worker.ts', import.meta.url), { type: 'module' }),
};

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
