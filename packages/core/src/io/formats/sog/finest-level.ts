import { SplatFileError } from '../../../data/errors.ts';
import { type LeafRun, type Run, readTree, splatsOf } from './scene-tree.ts';

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
  const { names, leaves, runsOfFile, environment } = readTree(json, file);
  const finest = new Set(leaves.map(({ runs }) => runs[0]));
  const files: LevelFile[] = [];
  for (const [index, runs] of [...runsOfFile].sort(([a], [b]) => a - b)) {
    const read = runs.filter((run) => finest.has(run));
    const path = names[index];
    if (read.length > 0)
      files.push({ path, count: splatsOf(runs), runs: read.length === runs.length ? null : read });
  }
  if (environment !== null) files.push({ path: environment, count: undefined, runs: null });
  if (files.length > MOST_FILES) {
    const message = `its finest level has ${files.length} files, more than ${MOST_FILES}. Open a part of the scene.`;
    throw new SplatFileError('too-large', file, message);
  }
  return { files, notes: notesOf([...finest]) };
}

/** Notes on parts that are shown otherwise than their finest level would have them. */
function notesOf(runs: readonly LeafRun[]): string[] {
  const finest = runs.reduce((least, { level }) => Math.min(least, level), Number.POSITIVE_INFINITY);
  const coarser = runs.filter(({ level }) => level > finest).length;
  if (coarser === 0) return [];
  return [`${coarser} of ${runs.length} parts have no splats of level ${finest}; their next level is shown.`];
}
