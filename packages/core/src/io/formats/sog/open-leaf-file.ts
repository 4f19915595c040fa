import type { LeafFile, LeafLevel } from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError } from '../../../data/errors.ts';
import type { SceneWorkers } from '../../loading/scene-workers.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { checkCount } from '../check-count.ts';
import { checkPath } from '../part-reader.ts';
import type { SogFile } from './pack-leaf.ts';
import type { SceneFilesOfSog } from './scene-files.ts';
import { imageNames } from './sog-images.ts';
import { MAX_META_BYTES, parseMeta, parseSogMeta, type SogMeta } from './sog-meta.ts';

/** A level of a leaf: consecutive splats of a file. */
export interface LeafSplats extends LeafLevel {
  readonly offset: number;
  /** Row of the first splat in a load of the finest levels; null for coarser levels. */
  readonly firstRow: number | null;
}

/** A fetched file, still compressed. */
export interface FetchedFile extends LeafFile {
  readonly bytes: number;
}

/** Facts about a file, according to the scene's metadata. */
export interface PromisedFile extends Pick<SogFile, 'path' | 'shDegree' | 'origin' | 'maxBytes'> {
  readonly count: number;
  readonly maxSplats: number | undefined;
}

let lastKey = 0;

/**
 * Reads the metadata of a file of a streamed scene.
 *
 * Rejects as `SceneFilesOfSog.read`, and with SplatFileError for wrong metadata.
 */
export async function readSogMeta(
  files: SceneFilesOfSog,
  path: string,
  signal?: AbortSignal,
  onBytes?: (bytes: number) => void,
): Promise<SogMeta> {
  const blob = await files.read(path, signal, onBytes);
  const bytes = new Uint8Array(await blob.slice(0, MAX_META_BYTES + 1).arrayBuffer());
  return parseSogMeta(parseMeta(bytes, path), path);
}

/**
 * Fetches a file of a streamed scene. Workers decode and pack its leaves from the compressed bytes.
 *
 * Rejects as `readSogMeta`, and with SplatFileError 'damaged' if the file contradicts the scene's
 * metadata.
 *
 * @param promised facts about it, according to the scene's metadata.
 */
export async function openLeafFile(
  files: SceneFilesOfSog,
  { count, maxSplats, ...promised }: PromisedFile,
  workers: SceneWorkers,
  signal: AbortSignal,
  onBytes: (bytes: number) => void,
): Promise<FetchedFile> {
  const { path } = promised;
  const meta = await readSogMeta(files, path, signal, onBytes);
  if (meta.count !== count) {
    const message = `it has ${meta.count} splats, where the scene says ${count}. Export the scene again.`;
    throw new SplatFileError('damaged', path, message);
  }
  checkCount(count, path, maxSplats ?? Number.POSITIVE_INFINITY);
  const paths = imageNames(meta).map((name) => folderOf(path) + name);
  for (const image of paths) checkPath(image, path);
  const blobs = await Promise.all(paths.map((image) => files.read(image, signal, onBytes)));
  const images = new Map(paths.map((image, i) => [image, blobs[i]]));
  const file: SogFile = { ...promised, key: ++lastKey, meta, images };
  return {
    bytes: blobs.reduce((sum, { size }) => sum + size, 0),
    pieces: ({ bounds }, level, end) => {
      const { offset, count: splats, firstRow } = level as LeafSplats;
      const leaf = { file, run: { offset, count: splats }, bounds, firstRow };
      return workers.call('packSogLeaf', leaf, { key: file.key, signal: end });
    },
  };
}
