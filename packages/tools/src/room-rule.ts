import { posix } from 'node:path';
import { isForTests } from './import-rule.ts';
import type { ModuleReference } from './module-references.ts';

/** An export of a package that has the name of a module: `@websplatter/kit/icon`. */
const EXPORT = /^@websplatter\/([^/]+)\/(.+)$/;

/** A module of the repository. */
export interface Module {
  readonly lines: number;
  readonly references: readonly ModuleReference[];
}

/** Modules with at most this many lines need two importers to justify a file of their own. */
const SMALL_LINES = 60;
/** A module is not merged into its only importer if the result would have more lines. */
const MOST_LINES = 450;
/** Effects and stages keep code of several tiers side by side: `NAME.reference.ts`. */
const TIER_FILE = /\.[a-z-]+\.tsx?$/;

/**
 * Lists small modules that should be merged into their only importer. An importer in another
 * package, or one that loads the module dynamically or as a worker, justifies a file.
 *
 * @param modules by path from the repository's root.
 * @param exceptions reasons by path.
 * @returns each violation as text, and exceptions that are not needed.
 */
export function lonelyModules(
  modules: ReadonlyMap<string, Module>,
  exceptions: Readonly<Record<string, string>>,
): string[] {
  const readers = new Map<string, Set<string>>();
  const neededAsFiles = new Set<string>();
  for (const [from, { references }] of modules) {
    if (isForTests(from)) continue;
    for (const { specifier, isStatic } of references) {
      const [, name, entry] = EXPORT.exec(specifier) ?? [];
      for (const folder of ['apps', 'packages'])
        for (const ending of ['ts', 'tsx']) neededAsFiles.add(`${folder}/${name}/src/${entry}.${ending}`);
      if (!specifier.startsWith('.')) continue;
      const to = posix.join(posix.dirname(from), specifier);
      if (!isStatic || packageOf(to) !== packageOf(from)) neededAsFiles.add(to);
      else readers.set(to, (readers.get(to) ?? new Set()).add(from));
    }
  }
  const lonely = [...readers].flatMap(([path, [reader, ...others]]) => {
    const lines = modules.get(path)?.lines ?? Number.POSITIVE_INFINITY;
    const isSmall = lines <= SMALL_LINES && lines + modules.get(reader)!.lines <= MOST_LINES;
    const mayMove = others.length === 0 && !neededAsFiles.has(path) && !isOfOtherKind(path, reader);
    return isSmall && mayMove ? [{ path, reader, lines }] : [];
  });
  const needless = Object.keys(exceptions).filter((each) => !lonely.some(({ path }) => path === each));
  return [
    ...lonely
      .filter(({ path }) => !Object.hasOwn(exceptions, path))
      .map(({ path, reader, lines }) => `${path}: ${lines} lines with one reader, ${reader}`),
    ...needless.map((path) => `${path}: an exception that is no longer needed`),
  ];
}

/**
 * Whether a module is a test helper, belongs to a tier, or has JSX that its importer cannot
 * contain.
 */
function isOfOtherKind(path: string, reader: string): boolean {
  const needsJsx = path.endsWith('.tsx') && !reader.endsWith('.tsx');
  return isForTests(path) || TIER_FILE.test(posix.basename(path)) || needsJsx || !/\.tsx?$/.test(reader);
}

function packageOf(path: string): string {
  return path.split('/').slice(0, 2).join('/');
}
