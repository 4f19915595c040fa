import type { LeafFile, LeafLevel, LeafScene, SceneLeaf } from '../../../data/bricks/leaf-scene.ts';
import { fetched, SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { chunkCountOf } from '../../../data/packing/chunks.ts';
import { originOfSamples } from '../../../data/packing/origin.ts';
import { type Bounds, movedBounds } from '../../../data/packing/packed-cloud.ts';
import { SceneWorkers } from '../../loading/scene-workers.ts';
import { FewRequests } from '../../sources/few-requests.ts';
import { KeptReads } from '../../sources/kept-reads.ts';
import { type KnownSource, ownPath } from '../../sources/known-source.ts';
import { filesBeside, openFiles } from '../../sources/open-files.ts';
import { openSource } from '../../sources/open-source.ts';
import type { ReadOptions } from '../../sources/splat-source.ts';
import type { JsonFields } from '../file-json.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { checkPath } from '../scene-file-reader.ts';
import { type PromisedFile, partsAt, readJson, readSogFile } from './fetch-file.ts';
import type { SogFile } from './pack-leaves.ts';
import { LEADING, type ReadSceneFile, readOpened, type SceneFilesOfSog } from './scene-files.ts';
import { type LeafRun, readTree, type SceneTree, type TreeLeaf } from './scene-tree.ts';
import { MAX_META_BYTES, parseMeta, parseSogMeta, type SogMeta } from './sog-meta.ts';

/**
 * Most bytes of fetched files that are kept, compressed, so that no file is fetched again while a view
 * turns. They are Blobs, which browsers keep out of the page's heap, large ones on disk.
 */
const KEPT_BYTES = 256 << 20;
/** Files that are fetched at a time. */
export const FILES_AT_ONCE = 4;
/** Directory size of an archive with 50,000 files. */
const DIRECTORY_BYTES = 4 << 20;
/** Assumed degree for metadata of version 1, which does not state it. */
const MOST_SH_DEGREE = 3;

/** A level of a leaf: consecutive splats of a file. */
interface LeafSplats extends LeafLevel {
  readonly offset: number;
  /** Row of the first splat in a load of the finest levels; null for coarser levels. */
  readonly firstRow: number | null;
}

/** A fetched file, still compressed. */
interface FetchedFile extends LeafFile {
  readonly bytes: number;
}

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
  source: KnownSource,
  options: Omit<ReadOptions, 'onProgress'> = {},
): Promise<LeafScene | null> {
  // A Blob may be an archive without a scene.
  let workers = source.kind === 'blob' ? null : startWorkers(source.name);
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

/** Starts all workers before there is work, since the first picture waits for files that they decode. */
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
  const read: LeafScene['read'] = async (index, end, onBytes) => {
    const promised = { ...files[index], shDegree, origin, maxBytes, maxSplats };
    const count = (bytes: number) => {
      fetchedBytes += bytes;
      onBytes?.(bytes);
    };
    const load = (ending: AbortSignal) =>
      fetches.run(() => openLeafFile(sceneFiles, promised, workers, ending, count), ending);
    const file = await kept.read(index, load, end);
    const pack: LeafFile['pack'] = async (parts, packEnd) => {
      try {
        return await file.pack(parts, packEnd);
      } catch (error) {
        // The server may have sent something else: it is asked again.
        if (error instanceof SplatFileError) kept.forget(index);
        throw error;
      }
    };
    return { pack };
  };
  return {
    ...{ name, splatCount, shDegree, origin, leaves, read },
    end: () => workers.end(),
    get fetchedBytes() {
      return fetchedBytes;
    },
    get keptBytes() {
      return kept.bytes;
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

let lastKey = 0;

/**
 * Fetches a file of a streamed scene, in a worker, since reading responses would take much of the
 * page's time. Workers decode and pack its leaves from the compressed bytes.
 *
 * Rejects as `readSogFile`.
 *
 * @param promised facts about it, according to the scene's metadata.
 */
async function openLeafFile(
  { name, fetched: from, read }: SceneFilesOfSog,
  promised: PromisedFile,
  workers: SceneWorkers,
  signal: AbortSignal,
  onBytes: (bytes: number) => void,
): Promise<FetchedFile> {
  const key = ++lastKey;
  const input = { scene: { name, fetched: from }, promised };
  const { json, images } = from
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

/**
 * Opens the files of a streamed SOG; null for an archive without one.
 *
 * Rejects as `openSource`, and with SplatFileError if an archive is damaged.
 */
async function openSceneFiles(
  source: KnownSource,
  options: Omit<ReadOptions, 'onProgress'>,
): Promise<SceneFilesOfSog | null> {
  if (source.kind === 'frame') return null;
  let from: Exclude<KnownSource, { kind: 'frame' }> = source;
  if (source.kind === 'blob' && !LEADING.test((source.blob as Partial<File>).name ?? options.name ?? '')) {
    // The directory at its end lists the names, so other archives need not be read.
    const end = await source.blob.slice(-DIRECTORY_BYTES).text();
    if (!/lod-meta\.json/i.test(end)) return null;
    const { archiveFiles } = await fetched('streaming', import('./archive-files.ts'));
    return archiveFiles(source.blob, source.name, options);
  }
  if (source.kind === 'blob')
    from = { ...source, kind: 'files', files: [source.blob], paths: [ownPath(source.blob)] };
  const opened = from.kind === 'files' ? openFiles(from, options) : await openSource(from, options);
  const meta = await readOpened(opened, options, MAX_META_BYTES + 1);
  const { name } = opened;
  if (from.kind === 'files') {
    const fileAt = filesBeside(from, name);
    const read: ReadSceneFile = async (path, _, onBytes) => {
      const file = fileAt(path);
      onBytes?.(file.size);
      return file;
    };
    return { name, meta, read };
  }
  return { name, meta, read: partsAt(opened, options), fetched: opened.fetched };
}
