import { join, sep } from 'node:path';

/** What an app that draws splats runs before it asks for a GPU. */
export const START = ['src/create-engine.ts', 'src/effects/index.ts', 'src/io/loading/load-splats.ts'];
const INDEX = 'src/index.ts';
/** What it runs from then on, and fetches meanwhile. */
const ENGINE = 'src/engine.ts';

/**
 * Returns a function that names the file that a module of core is built into; null: its entry's, or one of the bundler's choice. Apps
 * then fetch few files at first, and none of them brings what only the engine needs:
 *
 * - `base`: for the start of an app and for workers;
 * - `start`: for the start of an app alone, and what is in the public interface and in the engine;
 * - `packing`: for workers and for the engine, and in the public interface;
 * - `drawing`: for the engine alone.
 *
 * @param {string} folder of the package.
 * @param {Readonly<Record<string, string>>} entries of the package, by name: those of workers end with "-worker".
 */
export function coreChunk(folder, entries) {
  const workers = Object.keys(entries).filter((name) => name.endsWith('-worker'));
  // As the bundler names modules.
  const path = (file) => join(folder, file).replaceAll(sep, '/');
  /** By the graph of one build. */
  let known;
  return (id, graph) => {
    // All exports of these are for apps, whose bundlers would keep what only other files need.
    if (graph.getModuleInfo(id)?.isEntry || id === path(ENGINE)) return null;
    known ??= {
      isAtStart: needed(START.map(path), graph),
      isPublic: needed([path(INDEX)], graph),
      isOfEngine: needed([path(ENGINE)], graph),
      isOfWorkers: needed(
        workers.map((name) => path(entries[name])),
        graph,
      ),
    };
    const [isAtStart, isPublic, isOfEngine, isOfWorkers] = Object.values(known).map((all) => all.has(id));
    if (isAtStart) return isOfWorkers ? 'base' : 'start';
    if (isOfWorkers) return isPublic || isOfEngine ? 'packing' : null;
    if (!isOfEngine) return null;
    return isPublic ? 'start' : 'drawing';
  };
}

/** Modules with all that they import, but for what they fetch later. */
function needed(ids, graph) {
  const missing = ids.find((id) => !graph.getModuleInfo(id));
  if (missing) throw new Error(`core-chunks.mjs names ${missing}, which the build has no module for.`);
  const all = new Set(ids);
  // A set goes on to those that are added meanwhile.
  for (const id of all) for (const imported of graph.getModuleInfo(id)?.importedIds ?? []) all.add(imported);
  return all;
}
