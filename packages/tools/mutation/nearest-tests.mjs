// Finds the tests of `npm test` that reach a module by imports, the nearest first.
import { posix } from 'node:path';

const { basename, dirname, join } = posix;

/** A relative path in a text: of an import, a worker, or many modules at once. */
const RELATIVE_PATH = /(?<=['"`])\.\.?\/[^'"`\n]+/g;
/** A star or an expression in such a path: any name may take its place. */
const ANY = /\$\{[^}]*\}|\*+/;
/** An import or export that compilers remove. */
const TYPE_IMPORT = /^(?:import|export) type [^;]*;/gm;
const PACKAGE = /['"]@websplatter\/(\w+)(?:\/[\w-]+)?['"]/g;
/** Modules of WGSL, as others name them: `package::lib::merged_splat`. */
const WGSL_NAMES = /\bpackage::[\w:]+/g;
const TEST = /(?<!\.long(?:\.gpu)?)\.test\.tsx?$/;

/**
 * Lists what imports each module. Shaders are read by the modules beside them, all at once: tests of a shader's own name
 * come before those.
 *
 * @param {ReadonlyMap<string, string>} texts All modules, shaders and tests, by path from the root.
 * @returns {Map<string, Set<string>>}
 */
export function importersOf(texts) {
  const importers = new Map([...texts.keys()].map((path) => [path, new Set()]));
  const add = (imported, path) => importers.get(imported)?.add(path);
  const paths = [...texts.keys()];
  const shaders = new Map(
    paths.filter(isShader).map((path) => [basename(path, '.wgsl').replaceAll('-', '_'), path]),
  );
  for (const path of shaders.values()) {
    const beside = paths.filter((other) => dirname(other) === dirname(path) && !isShader(other));
    const own = beside.filter((other) => basename(other).startsWith(`${basename(path, '.wgsl')}.`));
    for (const other of [...own, ...beside.filter((module) => !TEST.test(module))]) add(path, other);
  }
  for (const [path, text] of texts) {
    const code = text.replace(TYPE_IMPORT, '');
    for (const [names] of code.matchAll(WGSL_NAMES))
      for (const name of names.split('::')) add(shaders.get(name), path);
    for (const [found] of code.matchAll(RELATIVE_PATH)) {
      const named = join(dirname(path), found.split('?')[0]);
      if (!ANY.test(named)) add(named, path);
      else for (const other of paths.filter(isMatch(named))) add(other, path);
    }
    for (const [, name] of code.matchAll(PACKAGE)) add(`packages/${name}/src/index.ts`, path);
  }
  return importers;
}

/**
 * Lists the tests that reach a module by imports, by how many modules lie between.
 *
 * @param {string} path Path of the module.
 * @param {ReadonlyMap<string, ReadonlySet<string>>} importers From {@link importersOf}.
 * @returns {string[]}
 */
export function nearestTests(path, importers) {
  const reached = new Set([path]);
  for (const module of reached) for (const importer of importers.get(module) ?? []) reached.add(importer);
  return [...reached].filter((module) => TEST.test(module));
}

function isMatch(pattern) {
  const parts = pattern
    .split(ANY)
    .map((part) =>
      part
        .replace(/[.()+]/g, '\\$&')
        .replace(/\{([^}]*)\}/g, (_, some) => `(?:${some.replaceAll(',', '|')})`),
    );
  const whole = new RegExp(`^${parts.join('[^/]*')}$`);
  return (path) => whole.test(path);
}

const isShader = (path) => path.endsWith('.wgsl');
