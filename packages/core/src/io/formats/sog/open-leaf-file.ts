import type { LeafFile, LeafLevel } from '../../../data/bricks/leaf-scene.ts';
import type { SceneWorkers } from '../../loading/scene-workers.ts';
import { type PromisedFile, readSogFile } from './fetch-file.ts';
import type { SogFile } from './pack-leaves.ts';
import type { SceneFilesOfSog } from './scene-files.ts';
import { parseSogMeta } from './sog-meta.ts';

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

let lastKey = 0;

/**
 * Fetches a file of a streamed scene, in a worker, since reading responses would take much of the
 * page's time. Workers decode and pack its leaves from the compressed bytes.
 *
 * Rejects as `readSogFile`.
 *
 * @param promised facts about it, according to the scene's metadata.
 */
export async function openLeafFile(
  { name, fetched, read }: SceneFilesOfSog,
  promised: PromisedFile,
  workers: SceneWorkers,
  signal: AbortSignal,
  onBytes: (bytes: number) => void,
): Promise<FetchedFile> {
  const key = ++lastKey;
  const input = { scene: { name, fetched }, promised };
  const { json, images } = fetched
    ? await workers.call('fetchSogFile', input, { key, signal, onProgress: onBytes })
    : await readSogFile(read, promised, signal, onBytes);
  const { path, shDegree, origin, maxBytes } = promised;
  const file: SogFile = { key, path, shDegree, origin, maxBytes, meta: parseSogMeta(json, path), images };
  return {
    bytes: [...images.values()].reduce((sum, { size }) => sum + size, 0),
    pack: (parts, end) => {
      const leaves = parts.map(({ leaf: { bounds }, level }) => {
        const { offset, count, firstRow } = level as LeafSplats;
        return { run: { offset, count }, bounds, firstRow };
      });
      return workers.call('packSogLeaves', { file, leaves }, { key, signal: end });
    },
  };
}
