import { SplatFileError } from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import { JsonFields } from './json-fields.ts';

/** A SOG of a streamed scene. */
export interface LevelFile {
  /** Path of its metadata, from the folder of the scene's. */
  readonly path: string;
  /** Splats in it; undefined where the scene does not say it. */
  readonly count: number | undefined;
}

/** Most files of a level: a scene of a billion splats has fewer. */
const MOST_FILES = 4096;

/** Whether JSON is that of streamed SOG (`lod-meta.json`). */
export function isStreamedMeta(json: unknown): boolean {
  return typeof json === 'object' && json !== null && Object.hasOwn(json, 'lodLevels');
}

/**
 * The files that make the finest level of a streamed scene, which together are all of it, and then its environment, which belongs
 * to every level. Each node of the tree has runs of splats in files; a file has the runs of one level and nothing else.
 *
 * @throws SplatFileError 'bad-header', 'damaged', 'too-large'; 'unknown-format' for later versions
 */
export function finestLevel(json: unknown, file: string): LevelFile[] {
  const meta = new JsonFields(json, '', file);
  const version = meta.get('version');
  if (version !== undefined && version !== 1) {
    const message = `it is streamed SOG of version ${shown(version)}; version 1 is read.`;
    throw new SplatFileError('unknown-format', file, message, { property: 'version' });
  }
  const levels = meta.count('lodLevels');
  const names = meta.names('filenames');
  const countsOfLevel = new Map<number, Map<number, number>>();
  const nodes = [meta.fields('tree')];
  for (let node = nodes.pop(); node; node = nodes.pop()) {
    if (node.has('children')) for (const child of node.list('children')) nodes.push(child);
    if (!node.has('lods')) continue;
    const lods = node.fields('lods');
    for (const key of lods.keys()) {
      const run = lods.fields(key);
      const level = Number(key);
      const index = run.count('file');
      if (!Number.isInteger(level) || level < 0 || level >= levels || index >= names.length) {
        const message = `a part of the scene is of level ${shown(key)} in the file ${index}, of ${levels} levels and ${names.length} files. Export the scene again.`;
        throw new SplatFileError('damaged', file, message, { property: 'tree' });
      }
      const counts = countsOfLevel.get(level) ?? new Map<number, number>();
      countsOfLevel.set(level, counts);
      counts.set(index, (counts.get(index) ?? 0) + run.count('count'));
    }
  }
  let finest = Number.POSITIVE_INFINITY;
  for (const level of countsOfLevel.keys()) finest = Math.min(finest, level);
  const files: LevelFile[] = [...(countsOfLevel.get(finest) ?? [])]
    .filter(([, count]) => count > 0)
    .sort(([a], [b]) => a - b)
    .map(([index, count]) => ({ path: names[index], count }));
  const environment = meta.get('environment');
  if (typeof environment === 'string') files.push({ path: environment, count: undefined });
  if (files.length > MOST_FILES) {
    const message = `its finest level has ${files.length} files, more than ${MOST_FILES}. Open a part of the scene.`;
    throw new SplatFileError('too-large', file, message);
  }
  return files;
}
