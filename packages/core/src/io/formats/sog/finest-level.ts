import { SplatFileError } from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import { JsonFields } from '../json-fields.ts';

/** Splats of a file, one after another. */
export interface Run {
  readonly offset: number;
  readonly count: number;
}

/** A SOG of a streamed scene. */
export interface LevelFile {
  /** Path of its metadata, from the folder of the scene's. */
  readonly path: string;
  /** Splats in it; undefined where the scene does not say it. */
  readonly count: number | undefined;
  /** Its runs to read, in order; null: all. */
  readonly runs: readonly Run[] | null;
}

/** Most files of a level: a scene of a billion splats has fewer. */
const MOST_FILES = 4096;

/** A run as a leaf of the tree has it. */
interface LeafRun extends Run {
  readonly level: number;
  /** Whether the leaf has no splats of a finer level. */
  isFinest: boolean;
}

/** Whether JSON is that of streamed SOG (`lod-meta.json`). */
export function isStreamedMeta(json: unknown): boolean {
  return typeof json === 'object' && json !== null && Object.hasOwn(json, 'lodLevels');
}

/**
 * The files that have the finest splats of each leaf of a streamed scene, which together are all of
 * it, and then its environment, which belongs to every level. A leaf of the tree has runs of splats
 * in files, one for each level; where it lacks the finest level, the next that it has is read, as
 * PlayCanvas shows it. A file has runs of one level, one behind another, and nothing else.
 *
 * @returns the files, and the notes of `FileFacts` on them.
 * @throws SplatFileError 'bad-header', 'damaged', 'too-large'; 'unknown-format' for later versions
 */
export function finestLevel(json: unknown, file: string): { files: LevelFile[]; notes: string[] } {
  const meta = new JsonFields(json, '', file, 'metadata of SOG');
  const version = meta.get('version');
  if (version !== undefined && version !== 1) {
    const message = `it is streamed SOG of version ${shown(version)}; version 1 is read.`;
    throw new SplatFileError('unknown-format', file, message, { property: 'version' });
  }
  const damaged = (property: string, message: string) =>
    new SplatFileError('damaged', file, `${message} Export the scene again.`, { property });
  const levels = meta.count('lodLevels');
  const names = meta.names('filenames');
  const runsOfFile = new Map<number, LeafRun[]>();
  const finestRuns: LeafRun[] = [];
  const nodes = [meta.fields('tree')];
  for (let node = nodes.pop(); node; node = nodes.pop()) {
    if (node.has('children')) for (const child of node.list('children')) nodes.push(child);
    if (!node.has('lods')) continue;
    const lods = node.fields('lods');
    let finest: LeafRun | undefined;
    for (const key of lods.keys()) {
      const fields = lods.fields(key);
      const level = /^(?:0|[1-9]\d*)$/.test(key) ? Number(key) : Number.NaN;
      const index = fields.count('file');
      if (!(level < levels && index < names.length)) {
        const message = `a part of the scene is of level ${shown(`"${key}"`)} in the file ${index}, of ${levels} levels and ${names.length} files.`;
        throw damaged('tree', message);
      }
      const run = { level, offset: fields.count('offset'), count: fields.count('count'), isFinest: false };
      if (run.count === 0) continue;
      const runs = runsOfFile.get(index) ?? [];
      runsOfFile.set(index, runs);
      runs.push(run);
      if (!finest || level < finest.level) finest = run;
    }
    if (!finest) continue;
    finest.isFinest = true;
    finestRuns.push(finest);
  }
  for (const [index, runs] of runsOfFile) checkRuns(runs, shown(names[index]), damaged);
  checkCounts(meta, [...runsOfFile.values()], damaged);

  const files: LevelFile[] = [];
  for (const [index, runs] of [...runsOfFile].sort(([a], [b]) => a - b)) {
    const read = runs.filter(({ isFinest }) => isFinest);
    const path = names[index];
    if (read.length > 0)
      files.push({ path, count: splatsOf(runs), runs: read.length === runs.length ? null : read });
  }
  const environment = meta.get('environment') ?? null;
  if (typeof environment === 'string') files.push({ path: environment, count: undefined, runs: null });
  else if (environment !== null) meta.fail('environment', 'the path of a file');
  if (files.length > MOST_FILES) {
    const message = `its finest level has ${files.length} files, more than ${MOST_FILES}. Open a part of the scene.`;
    throw new SplatFileError('too-large', file, message);
  }
  return { files, notes: notesOf(finestRuns) };
}

/** Splats of runs. */
export function splatsOf(runs: readonly Run[]): number {
  return runs.reduce((sum, { count }) => sum + count, 0);
}

type Damaged = (property: string, message: string) => SplatFileError;

/** Throws unless the runs of a file, which it sorts, are all of it and of one level. */
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

/** Throws unless files have as many splats as the scene says, which it may leave out. */
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

/** Notes on parts that are shown otherwise than their finest level would have them. */
function notesOf(runs: readonly LeafRun[]): string[] {
  const finest = runs.reduce((least, { level }) => Math.min(least, level), Number.POSITIVE_INFINITY);
  const coarser = runs.filter(({ level }) => level > finest).length;
  if (coarser === 0) return [];
  return [`${coarser} of ${runs.length} parts have no splats of level ${finest}; their next level is shown.`];
}
