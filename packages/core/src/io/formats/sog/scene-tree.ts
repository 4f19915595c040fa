import { type FileFinding, SplatFileError } from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import { JsonFields } from '../file-json.ts';

/** Consecutive splats of a file. */
export interface Run {
  readonly offset: number;
  readonly count: number;
}

/** The splats of a tree leaf at one level. */
export interface LeafRun extends Run {
  /** 0 is the finest level. */
  readonly level: number;
  /** Index of the file. */
  readonly file: number;
}

/** A leaf of a streamed scene's tree. */
export interface TreeLeaf {
  /** JSON of the leaf's node, with its bounds and errors. */
  readonly node: JsonFields;
  /** One run or more, the finest level first; levels are unique. */
  readonly runs: readonly LeafRun[];
}

/** The metadata of a streamed scene. */
export interface SceneTree {
  readonly levelCount: number;
  /** Paths of the files, relative to the scene's folder. */
  readonly names: readonly string[];
  readonly leaves: readonly TreeLeaf[];
  /** The runs of each referenced file, in order. They cover the file and have the same level. */
  readonly runsOfFile: ReadonlyMap<number, readonly LeafRun[]>;
  /** Path of the file that belongs to every level; null if there is none. */
  readonly environment: string | null;
}

/** Whether the JSON is metadata of a streamed SOG (`lod-meta.json`). */
export function isStreamedMeta(json: unknown): boolean {
  return typeof json === 'object' && json !== null && Object.hasOwn(json, 'lodLevels');
}

/**
 * Reads the tree of a streamed scene. Leaves without splats are omitted.
 *
 * @throws SplatFileError 'bad-header', 'damaged'; 'unknown-format' for later versions
 */
export function readTree(json: unknown, file: string): SceneTree {
  const meta = new JsonFields(json, '', file, 'metadata of SOG');
  const version = meta.get('version');
  if (version !== undefined && version !== 1) {
    const finding: FileFinding = [`is streamed SOG of version ${shown(version)}`, 'version 1 is read'];
    throw new SplatFileError('unknown-format', file, finding, { property: 'version' });
  }
  const damaged = (property: string, message: string) =>
    new SplatFileError('damaged', file, `${message} Export the scene again.`, { property });
  const levelCount = meta.count('lodLevels');
  const names = meta.names('filenames');
  const runsOfFile = new Map<number, LeafRun[]>();
  const leaves: TreeLeaf[] = [];
  const nodes = [meta.fields('tree')];
  for (let node = nodes.pop(); node; node = nodes.pop()) {
    if (node.has('children')) for (const child of node.list('children')) nodes.push(child);
    if (!node.has('lods')) continue;
    const lods = node.fields('lods');
    const leafRuns: LeafRun[] = [];
    for (const key of lods.keys()) {
      const fields = lods.fields(key);
      const level = /^(?:0|[1-9]\d*)$/.test(key) ? Number(key) : Number.NaN;
      const index = fields.count('file');
      if (!(level < levelCount && index < names.length)) {
        const message = `a part of the scene is of level ${shown(`"${key}"`)} in the file ${index}, of ${levelCount} levels and ${names.length} files.`;
        throw damaged('tree', message);
      }
      const run = { level, file: index, offset: fields.count('offset'), count: fields.count('count') };
      if (run.count === 0) continue;
      const runs = runsOfFile.get(index) ?? [];
      runsOfFile.set(index, runs);
      runs.push(run);
      leafRuns.push(run);
    }
    if (leafRuns.length > 0) leaves.push({ node, runs: leafRuns.sort((a, b) => a.level - b.level) });
  }
  for (const [index, runs] of runsOfFile) checkRuns(runs, shown(names[index]), damaged);
  checkCounts(meta, [...runsOfFile.values()], damaged);
  const environment = meta.get('environment') ?? null;
  if (typeof environment !== 'string' && environment !== null)
    return meta.fail('environment', 'the path of a file');
  return { levelCount, names, leaves, runsOfFile, environment };
}

/** Total number of splats. */
export function splatsOf(runs: readonly Run[]): number {
  return runs.reduce((sum, { count }) => sum + count, 0);
}

type Damaged = (property: string, message: string) => SplatFileError;

/** Sorts the runs of a file. Throws unless they cover the file and have the same level. */
function checkRuns(runs: LeafRun[], name: string, damaged: Damaged): void {
  let end = 0;
  for (const { level, offset, count } of runs.sort((a, b) => a.offset - b.offset)) {
    if (level !== runs[0].level)
      throw damaged('tree', `the file ${name} has splats of the levels ${runs[0].level} and ${level}.`);
    if (offset !== end) {
      const what = offset < end ? 'overlap' : 'leave out splats';
      throw damaged(
        'tree',
        `the parts of the scene in the file ${name} ${what} at ${Math.min(offset, end)}.`,
      );
    }
    end += count;
  }
}

/** Throws unless the splat counts of files match the scene's metadata, if it states them. */
function checkCounts(meta: JsonFields, files: readonly LeafRun[][], damaged: Damaged): void {
  const found = new Map<number, number>();
  for (const runs of files) found.set(runs[0].level, (found.get(runs[0].level) ?? 0) + splatsOf(runs));
  if (meta.has('count')) {
    const count = [...found.values()].reduce((sum, each) => sum + each, 0);
    if (meta.count('count') !== count)
      throw damaged('count', `its tree has ${count} splats, where it says ${meta.count('count')}.`);
  }
  if (!meta.has('counts')) return;
  const counts = meta.get('counts');
  if (!Array.isArray(counts)) meta.fail('counts', 'a list of counts');
  for (const level of [...found.keys(), ...counts.keys()]) {
    const count = found.get(level) ?? 0;
    if (counts[level] === count) continue;
    const message = `its tree has ${count} splats of level ${level}, where it says ${shown(counts[level])}.`;
    throw damaged('counts', message);
  }
}
