import { posix } from 'node:path';
import type { ModuleReference } from './module-references.ts';
import type { Arrows } from './tiers.ts';

export interface ImportRule {
  /** Allowed imports between packages, by folder name. */
  readonly packages: Arrows;
  /** Allowed imports between folders and files at a package's root, by the package's root. */
  readonly tiers: Readonly<Record<string, Arrows>>;
  /** Files that may refer to another package's files by path, with reasons. */
  readonly pathExceptions: Readonly<Record<string, string>>;
}

export type RepositoryFiles = ReadonlyMap<string, readonly ModuleReference[]>;

interface Dependency {
  readonly from: string;
  /** A file's path, a glob, or a package's name. */
  readonly to: string;
  readonly isType: boolean;
}

/** A table of allowed imports, and the lookup of a path's name in it. */
interface Table {
  readonly kind: 'tier' | 'package';
  readonly arrows: Arrows;
  /** Undefined if the table does not cover the path. */
  nameOf(path: string): string | undefined;
}

/**
 * Returns each violation as text, imports as `FILE → FILE: WHY`.
 *
 * @param files references of each file, by path from the root: every file that a module may import.
 */
export function importViolations(files: RepositoryFiles, rule: ImportRule): string[] {
  const dependencies = dependenciesOf(files);
  const paths = [...files.keys()];
  const packages: Table = { kind: 'package', arrows: rule.packages, nameOf: packageOf };
  const tiers = Object.entries(rule.tiers).map(
    ([root, arrows]): Table => ({
      kind: 'tier',
      arrows,
      nameOf: (path) => (path.startsWith(root) ? tierOf(path.slice(root.length), arrows) : undefined),
    }),
  );
  const outsideExceptions = dependencies.filter(
    ({ from, to }) => to.startsWith('@') || !Object.hasOwn(rule.pathExceptions, from),
  );
  return [
    ...tableFlaws(packages, paths),
    ...tiers.flatMap((table) => tableFlaws(table, paths)),
    ...wrongArrows(packages, outsideExceptions),
    ...tiers.flatMap((table) => wrongArrows(table, dependencies)),
    ...importsOfTests(dependencies),
    ...wrongPaths(dependencies, rule.pathExceptions),
    ...circles(dependencies),
  ];
}

function dependenciesOf(files: RepositoryFiles): Dependency[] {
  return [...files].flatMap(([from, references]) =>
    references.flatMap(({ specifier, isType }) => {
      if (specifier.startsWith('@')) return { from, to: specifier, isType };
      const [path] = specifier.split('?');
      const to = posix.join(posix.dirname(from), path);
      // Other paths refer to files and folders that are read as data.
      return files.has(to) || specifier.includes('*') ? { from, to, isType } : [];
    }),
  );
}

/** Folder name of the package that contains a path or that an import names. */
function packageOf(path: string): string | undefined {
  return /^(?:@websplatter|packages|apps)\/([^/]+)/.exec(path)?.[1] ?? /^(?:e2e|shaders)\b/.exec(path)?.[0];
}

/**
 * A file `NAME.TIER.ts` belongs to that tier wherever it is; other files belong to their folder.
 */
function tierOf(path: string, tiers: Arrows): string {
  const [, ending] = /\.(\w+)\.ts$/.exec(path) ?? [];
  return Object.hasOwn(tiers, ending ?? '') ? ending : path.split('/')[0];
}

/** Whether only tests use a file. */
export function isForTests(path: string): boolean {
  return /\.test(?:-d)?\.(?:tsx?|mjs)$|\/testing\/|\/gpu-test(?:\.ts)?$|^e2e\//.test(path);
}

interface Arrow {
  readonly to: string;
  readonly only: string | undefined;
}

function arrowsOf(line: string): Arrow[] {
  return line
    .split(' ')
    .filter((word) => word !== '')
    .map((word) => {
      const [, to, only] = /^([^(]+)(?:\((types|tests)\))?$/.exec(word) ?? [];
      if (!to) throw new RangeError(`"${word}" is no arrow: write "name", "name(types)" or "name(tests)".`);
      return { to, only };
    });
}

function tableFlaws({ kind, arrows, nameOf }: Table, paths: readonly string[]): string[] {
  const names = Object.keys(arrows);
  const found = new Set(paths.filter((path) => kind === 'package' || !isForTests(path)).map(nameOf));
  found.delete(undefined);
  return [
    ...[...found].flatMap((name) =>
      names.includes(name!) ? [] : `${name}: this ${kind} has no line that says what it may import`,
    ),
    ...names.flatMap((name) => (found.has(name) ? [] : `${name}: has a line, but there is no such ${kind}`)),
    ...names.flatMap((name, line) =>
      arrowsOf(arrows[name]).flatMap(({ to, only }) =>
        only === 'tests' || names.slice(0, line).includes(to)
          ? []
          : `${name} → ${to}: a ${kind} may only import those above it in the table`,
      ),
    ),
  ];
}

/** Imports that no arrow allows, and arrows that no import needs. */
function wrongArrows({ kind, arrows, nameOf }: Table, dependencies: readonly Dependency[]): string[] {
  const violations: string[] = [];
  const used = new Set<Arrow>();
  const table = new Map(Object.entries(arrows).map(([name, line]) => [name, arrowsOf(line)]));
  for (const { from, to, isType } of dependencies) {
    const [fromName, toName] = [nameOf(from), nameOf(to)];
    if (!fromName || !toName || fromName === toName) continue;
    const isTest = isForTests(from);
    if (isTest && kind === 'tier') continue;
    const arrow = table.get(fromName)?.find((each) => each.to === toName);
    const isAllowed = arrow && (arrow.only === 'types' ? isType : arrow.only === undefined || isTest);
    if (!isAllowed) violations.push(`${from} → ${to}: ${fromName} may not import ${toName}${onlyIn(arrow)}`);
    // An arrow for all files is unnecessary if only tests use it.
    else if (!isTest || arrow.only === 'tests') used.add(arrow);
  }
  for (const [name, row] of table)
    for (const arrow of row)
      if (!used.has(arrow)) violations.push(`${name} → ${arrow.to}: allowed, but nothing needs it`);
  return violations;
}

function onlyIn(arrow: Arrow | undefined): string {
  if (arrow?.only === 'types') return ' but for its types';
  return arrow?.only === 'tests' ? ' but in its tests' : '';
}

function importsOfTests(dependencies: readonly Dependency[]): string[] {
  return dependencies.flatMap(({ from, to }) =>
    isForTests(to) && !isForTests(from) ? `${from} → ${to}: only tests may import what is for tests` : [],
  );
}

function wrongPaths(
  dependencies: readonly Dependency[],
  exceptions: Readonly<Record<string, string>>,
): string[] {
  const used = new Set<string>();
  const violations = dependencies.flatMap(({ from, to }) => {
    const [fromName, toName] = [packageOf(from), packageOf(to)];
    // Shaders have no exports: they are read by path.
    if (to.startsWith('@') || !fromName || !toName || fromName === toName || toName === 'shaders') return [];
    used.add(from);
    return Object.hasOwn(exceptions, from) ? [] : `${from} → ${to}: import it from @websplatter/${toName}`;
  });
  const needless = Object.keys(exceptions).filter((path) => !used.has(path));
  return [...violations, ...needless.map((path) => `${path}: an exception that is no longer needed`)];
}

/** Enough import cycles to cover every file that is in one. */
function circles(dependencies: readonly Dependency[]): string[] {
  const importsOf = new Map<string, string[]>(dependencies.map(({ from }) => [from, []]));
  for (const { from, to } of dependencies) importsOf.get(from)!.push(to);
  dropEnds(importsOf);
  const reported = new Set<string>();
  return [...importsOf.keys()].flatMap((path) => {
    const circle = reported.has(path) ? null : shortestCircle(path, importsOf);
    if (!circle) return [];
    for (const each of circle) reported.add(each);
    return `${[...circle, path].join(' → ')}: a circle`;
  });
}

/** Drops files that import nothing, then those that import only dropped ones, and so on: none is in a cycle. */
function dropEnds(importsOf: Map<string, string[]>): void {
  let before: number;
  do {
    before = importsOf.size;
    for (const [path, imports] of importsOf)
      if (!imports.some((to) => importsOf.has(to))) importsOf.delete(path);
  } while (importsOf.size < before);
}

/** Shortest cycle through `start`, by breadth-first search. */
function shortestCircle(start: string, importsOf: ReadonlyMap<string, readonly string[]>): string[] | null {
  const ways = new Map([[start, [start]]]);
  for (const [path, way] of ways)
    for (const to of importsOf.get(path) ?? []) {
      if (to === start) return way;
      if (!ways.has(to)) ways.set(to, [...way, to]);
    }
  return null;
}
