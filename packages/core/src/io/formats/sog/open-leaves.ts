import type { LeafScene, SceneLeaf } from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { chunkCountOf } from '../../../data/packing/chunks.ts';
import { originOfSamples } from '../../../data/packing/origin.ts';
import { type Bounds, movedBounds } from '../../../data/packing/packed-cloud.ts';
import { SceneWorkers } from '../../loading/scene-workers.ts';
import { FewRequests } from '../../sources/few-requests.ts';
import { KeptReads } from '../../sources/kept-reads.ts';
import { isBlob, sourceName } from '../../sources/source-kind.ts';
import type { ReadOptions, SplatSource } from '../../sources/splat-source.ts';
import { checkCount } from '../check-count.ts';
import type { JsonFields } from '../json-fields.ts';
import { checkPath } from '../part-reader.ts';
import { readJson } from './fetch-file.ts';
import { type FetchedFile, type LeafSplats, openLeafFile } from './open-leaf-file.ts';
import { openSceneFiles } from './open-scene-files.ts';
import type { SceneFilesOfSog } from './scene-files.ts';
import { type LeafRun, readTree, type SceneTree, type TreeLeaf } from './scene-tree.ts';
import { parseMeta, parseSogMeta, type SogMeta } from './sog-meta.ts';

/**
 * Most bytes of fetched files that are kept, compressed, so that no file is fetched again while a view
 * turns. They are Blobs, which browsers keep out of the page's heap, large ones on disk.
 */
const KEPT_BYTES = 256 << 20;
/** Files that are fetched at a time. */
export const FILES_AT_ONCE = 4;
/** Assumed degree for metadata of version 1, which does not state it. */
const MOST_SH_DEGREE = 3;

/** A file of the scene. */
interface SceneFile {
  readonly path: string;
  /** Number of splats. */
  readonly count: number;
}

/**
 * Opens a streamed SOG; each file is fetched on request. The scene's metadata is read now, and the
 * metadata of a file of the finest level and of the environment.
 *
 * Rejects with SplatSourceError if a file cannot be fetched, and SplatFileError if the scene is
 * damaged or lacks a file. Rejects with InvalidArgumentError if the value is no source, and the
 * signal's reason.
 *
 * @returns null for an archive without `lod-meta.json`.
 */
export async function openLeaves(
  source: SplatSource,
  options: Omit<ReadOptions, 'onProgress'> = {},
): Promise<LeafScene | null> {
  // A Blob may be an archive without a scene.
  let workers = isBlob(source) ? null : startWorkers(options.name ?? sourceName(source));
  try {
    const files = await openSceneFiles(source, options);
    if (!files) return null;
    workers ??= startWorkers(files.name);
    return await openWith(workers, files, options);
  } catch (error) {
    workers?.end();
    throw error;
  }
}

/** Workers that start at once: the first picture waits for what they do. */
function startWorkers(sceneName: string): SceneWorkers {
  const workers = new SceneWorkers(sceneName);
  workers.startAll();
  return workers;
}

async function openWith(
  workers: SceneWorkers,
  sceneFiles: SceneFilesOfSog,
  { signal, maxBytes, maxSplats }: Omit<ReadOptions, 'onProgress'>,
): Promise<LeafScene> {
  const { name } = sceneFiles;
  const tree = readTree(parseMeta(sceneFiles.meta, name), name);
  const metaOf = async (path: string) => parseSogMeta(await readJson(sceneFiles.read, path, signal), path);
  const { leaves, files, finestFile, origin } = leavesOf(tree, name);
  const { environment } = tree;
  const metas: SogMeta[] = [];
  if (finestFile !== null) metas.push(await metaOf(files[finestFile].path));
  const finestRows = leaves.reduce((sum, { levels }) => sum + levels[0].count, 0);
  let splatCount = finestRows;
  if (environment !== null) {
    const meta = await metaOf(environment);
    metas.push(meta);
    files.push({ path: environment, count: meta.count });
    const level = levelOf({ file: files.length - 1, offset: 0, count: meta.count }, finestRows, 0);
    leaves.push({ bounds: null, levels: [level] });
    splatCount += meta.count;
  }
  checkCount(splatCount, name, Number.POSITIVE_INFINITY);
  const degrees = metas.map(({ harmonics }) => (harmonics ? (harmonics.degree ?? MOST_SH_DEGREE) : 0));
  const shDegree = degrees.reduce((most, degree) => (degree > most ? degree : most));
  const { isAntialiased } = metas[0];

  let fetchedBytes = 0;
  const fetches = new FewRequests(FILES_AT_ONCE);
  const kept = new KeptReads<FetchedFile>(KEPT_BYTES, ({ bytes }) => bytes);
  const read: LeafScene['read'] = (index, end, onBytes) => {
    const promised = { ...files[index], shDegree, origin, maxBytes, maxSplats };
    const count = (bytes: number) => {
      fetchedBytes += bytes;
      onBytes?.(bytes);
    };
    const load = (ending: AbortSignal) =>
      fetches.run(() => openLeafFile(sceneFiles, promised, workers, ending, count), ending);
    return kept.read(index, load, end);
  };
  return {
    ...{ name, splatCount, shDegree, origin, leaves, read },
    end: () => workers.end(),
    get fetchedBytes() {
      return fetchedBytes;
    },
    ...(isAntialiased !== undefined && { isAntialiased }),
  };
}

/** The leaves, files and origin of a scene; `finestFile` has splats of the finest level. */
function leavesOf(
  tree: SceneTree,
  name: string,
): { leaves: SceneLeaf[]; files: SceneFile[]; finestFile: number | null; origin: Vec3 } {
  const finest = new Set(tree.leaves.map(({ runs }) => runs[0]));
  const firstRows = new Map<LeafRun, number>();
  let rows = 0;
  let finestFile: number | null = null;
  const files = tree.names.map((path) => ({ path, count: 0 }));
  const paths = new Set<string>();
  for (const [index, runs] of [...tree.runsOfFile].sort(([a], [b]) => a - b)) {
    const { path } = files[index];
    checkPath(path, name);
    if (paths.has(path)) {
      const message = `it names the file ${path} twice. Export the scene again.`;
      throw new SplatFileError('damaged', name, message);
    }
    paths.add(path);
    for (const run of runs) {
      files[index].count += run.count;
      if (!finest.has(run)) continue;
      if (finestFile === null) finestFile = index;
      firstRows.set(run, rows);
      rows += run.count;
    }
  }
  if (tree.environment !== null) checkPath(tree.environment, name);
  const bounded = tree.leaves.map((leaf) => ({ leaf, bounds: boundsOf(leaf.node) }));
  const middles = bounded.flatMap(({ bounds: { min, max } }) =>
    min.map((low, axis) => (low + max[axis]) / 2),
  );
  const origin = originOfSamples(Float64Array.from(middles));
  const [x, y, z] = origin;
  const leaves = bounded.map(({ leaf, bounds }): SceneLeaf => {
    const errors = errorsOf(leaf, bounds, tree.levelCount);
    const levels = leaf.runs.map((run, i) => levelOf(run, firstRows.get(run) ?? null, errors[i]));
    return { bounds: movedBounds(bounds, [-x, -y, -z]), levels };
  });
  return { leaves, files, finestFile, origin };
}

function levelOf(
  { file, offset, count }: Omit<LeafRun, 'level'>,
  firstRow: number | null,
  error: number,
): LeafSplats {
  return { file, offset, count, firstRow, error, chunkCount: chunkCountOf(count) };
}

function boundsOf(node: JsonFields): Bounds {
  const bound = node.fields('bound');
  const [minX, minY, minZ] = bound.numbers('min', 3);
  const [maxX, maxY, maxZ] = bound.numbers('max', 3);
  if (!(minX <= maxX && minY <= maxY && minZ <= maxZ)) bound.fail('max', 'no less than min');
  return { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] };
}

/**
 * Error of each level of a leaf against its finest level, in scene units. It is the level's share
 * of wrong energy (`errors`; 1 if the file has none) times its splat spacing. The spacing assumes a
 * surface that fills the leaf's bounds.
 */
function errorsOf({ node, runs }: TreeLeaf, { min, max }: Bounds, levelCount: number): number[] {
  const shares = node.has('errors') ? node.numbers('errors', levelCount) : null;
  if (shares?.some((share) => share < 0)) node.fail('errors', 'a list of numbers from 0');
  const [, middle, longest] = max.map((value, axis) => value - min[axis]).sort((a, b) => a - b);
  let largest = 0;
  return runs.map(({ level, count }, i) => {
    if (i === 0) return 0;
    const spacing = Math.max(Math.sqrt((longest * middle) / count), longest / count);
    largest = Math.max(largest, spacing * Math.sqrt(Math.min(1, shares?.[level] ?? 1)));
    return largest;
  });
}
